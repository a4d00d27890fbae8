"""Failures on the way from a part to its cloud."""

from pathlib import Path

import numpy as np

from industnerf.artifacts.cloud import save_extra_clouds
from industnerf.artifacts.files import write_json
from industnerf.artifacts.split import SplitAssignment
from industnerf.report.study import StudyFolders, _count_empty_predictions, failures_of

HANDED_ON = {"torn": "no faces"}


def failing(folder: Path, failures: dict[str, str]) -> Path:
    write_json(folder / "failures.json", {"schema": 1, "failures": failures})
    return folder


def test_every_stage_says_what_failed_in_it_and_once(tmp_path: Path):
    """Each stage also lists what failed before it."""
    folders = StudyFolders(
        solids=tmp_path,
        parts=failing(tmp_path / "parts", HANDED_ON),
        views=failing(tmp_path / "views", HANDED_ON | {"dark": "no lamp"}),
        split=tmp_path,
        truth=failing(tmp_path / "truth", HANDED_ON | {"thin": "too few samples"}),
        procedural=tmp_path,
        states=tmp_path,
        clouds=tmp_path / "clouds",
        scores=tmp_path / "scores",
    )
    before = HANDED_ON | {"dark": "no lamp"}
    failing(folders.clouds / "hull", before | {"blurred": "no outline"})
    assert failures_of(folders, ["hull"]) == {
        "parts": HANDED_ON,
        "views": {"dark": "no lamp"},
        "truth": {"thin": "too few samples"},
        "hull": {"blurred": "no outline"},
    }


def test_predictions_without_points_are_counted_by_split(tmp_path: Path):
    """The first prediction is the cloud itself; the extra clouds are the other seven."""
    some, none = np.ones((4, 3)), np.empty((0, 3))
    for part, others in {"a": [some, none, none], "b": [some], "c": [none, some]}.items():
        (tmp_path / "net" / part).mkdir(parents=True)
        save_extra_clouds(tmp_path / "net" / part, others)
    index = {"schema": 1, "keys": dict.fromkeys("abcd", "")}
    write_json(tmp_path / "net" / "index.json", index)
    places = {part: SplitAssignment("dev" if part == "c" else "test", None) for part in "abcd"}
    assert _count_empty_predictions(tmp_path, ["net"], places) == {
        ("net", "test"): 2,
        ("net", "dev"): 1,
    }
