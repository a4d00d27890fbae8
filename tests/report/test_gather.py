"""Failures on the way from a part to its score."""

from pathlib import Path

from industnerf.artifacts.files import write_json
from industnerf.report.gather import Folders, failures_of

HANDED_ON = {"torn": "no faces"}


def failing(folder: Path, failures: dict[str, str]) -> Path:
    write_json(folder / "failures.json", {"schema": 1, "failures": failures})
    return folder


def test_every_stage_says_what_failed_in_it_and_once(tmp_path: Path):
    """Each stage also lists what failed before it."""
    folders = Folders(
        solids=tmp_path,
        parts=failing(tmp_path / "parts", HANDED_ON),
        views=failing(tmp_path / "views", HANDED_ON | {"dark": "no lamp"}),
        split=tmp_path,
        truth=failing(tmp_path / "truth", HANDED_ON | {"thin": "too few samples"}),
        states=tmp_path,
        clouds=tmp_path / "clouds",
        scores=tmp_path / "scores",
    )
    before = HANDED_ON | {"dark": "no lamp"}
    failing(folders.clouds / "hull", before | {"blurred": "no outline"})
    failing(folders.scores / "hull", {"far": "not a number"})
    assert failures_of(folders, ["hull"]) == {
        "parts": HANDED_ON,
        "views": {"dark": "no lamp"},
        "truth": {"thin": "too few samples"},
        "hull": {"blurred": "no outline"},
        "scoring hull": {"far": "not a number"},
    }
