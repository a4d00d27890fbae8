"""Studies whose scores are given, for tests of what a report makes of them."""

from collections.abc import Collection
from pathlib import Path
from typing import Any

from industnerf.artifacts.part import Part
from industnerf.artifacts.scores import PartScore, Score
from industnerf.artifacts.split import Place
from industnerf.methods import load_method
from industnerf.report.gather import Folders, Study
from industnerf.report.given import Views
from industnerf.schema import ReportParams

SETTINGS = ReportParams(resamples=200, interval=0.9, sheet_parts=4)
FLOOR = 0.01
PROTOCOLS = ("P1-even", "P1-iid", "P1-full")


def study_of(
    parts: list[Part], emds: dict[str, list[float]], dev: Collection[str] = (), **changes: Any
) -> Study:
    """`emds` of each method on `parts`, in their order: 0.1 more under `P1-iid`, 0.2 `P1-full`.

    A part in `dev` is tuned on.  A part on which the EMD is infinite failed, with the EMD 1.
    """
    names = [part.part_id for part in parts]
    values = {
        "preset": "smoke",
        "seed": 0,
        "views": 12,
        "methods": {name: load_method(name) for name in emds},
        "parts": {part.part_id: part for part in parts},
        "places": {name: Place("dev" if name in dev else "test", None) for name in names},
        "scores": [row for name in emds for row in _scores(name, names, emds[name])],
        "failures": {},
        "remarks": {},
        "training": dict.fromkeys(emds, (0, 0)),
        "lessons": {},
        "seen_by_training": {},
        "seen_by_rig": dict.fromkeys(names, 1.0),
        "folders": Folders(*[Path("nowhere")] * 8),
        "given": dict.fromkeys(emds, Views(12)),
        "seeds_sd": {},
        "empty_answers": {},
    }
    return Study(**(values | changes))


def _scores(method: str, names: list[str], emds: list[float]) -> list[PartScore]:
    return [
        PartScore(
            name, method, Score("emd", protocol, min(emd, 1.0) + 0.1 * i, FLOOR, "diagonal", status)
        )
        for name, emd in zip(names, emds, strict=True)
        for i, protocol in enumerate(PROTOCOLS)
        for status in ["failed" if emd == float("inf") else "ok"]
    ]
