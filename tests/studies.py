"""Studies whose scores are given, for tests of what a report makes of them."""

from collections.abc import Collection
from pathlib import Path
from typing import Any

from industnerf.artifacts.part import Part
from industnerf.artifacts.scores import PartScore, Score
from industnerf.artifacts.split import SplitAssignment
from industnerf.methods import load_method
from industnerf.report.study import InputViews, Study, StudyFolders
from industnerf.schema import ReportParams

SETTINGS = ReportParams(bootstrap_resamples=200, confidence_level=0.9, contact_sheet_parts=4)
FLOOR = 0.01
PROTOCOLS = ("P1-even", "P1-iid", "P1-full")


def make_study(
    parts: list[Part], emds: dict[str, list[float]], dev: Collection[str] = (), **changes: Any
) -> Study:
    """`emds` of each method on `parts`, in their order: 0.1 more under `P1-iid`, 0.2 `P1-full`.

    A part in `dev` is tuned on.  A part on which the EMD is infinite failed, with the EMD 1.
    """
    part_ids = [part.part_id for part in parts]
    values = {
        "preset": "smoke",
        "seed": 0,
        "num_train_views": 12,
        "methods": {name: load_method(name) for name in emds},
        "parts": {part.part_id: part for part in parts},
        "assignments": {
            name: SplitAssignment("dev" if name in dev else "test", None) for name in part_ids
        },
        "scores": [row for name in emds for row in _make_scores(name, part_ids, emds[name])],
        "failures": {},
        "input_warnings": {},
        "parameters_and_steps": dict.fromkeys(emds, (0, 0)),
        "training_summaries": {},
        "train_visible_share": {},
        "rig_visible_share": dict.fromkeys(part_ids, 1.0),
        "folders": StudyFolders.all_at(Path("nowhere")),
        "input_views": dict.fromkeys(emds, InputViews(12)),
        "seeds_sd": {},
        "empty_predictions": {},
    }
    return Study(**(values | changes))


def _make_scores(method: str, names: list[str], emds: list[float]) -> list[PartScore]:
    return [
        PartScore(
            name, method, Score("emd", protocol, min(emd, 1.0) + 0.1 * i, FLOOR, "diagonal", status)
        )
        for name, emd in zip(names, emds, strict=True)
        for i, protocol in enumerate(PROTOCOLS)
        for status in ["failed" if emd == float("inf") else "ok"]
    ]
