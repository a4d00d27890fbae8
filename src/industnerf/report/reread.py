"""A published study read back: a table that got a column is made anew of its scores, not run anew.

What is not published stays empty: failures with their reasons, remarks, what cameras saw.  The goal
about what the reference rig saw is the published one.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from industnerf.artifacts.part import Part
from industnerf.artifacts.scores import PartScore, Score
from industnerf.artifacts.split import Place
from industnerf.config import build, read_yaml
from industnerf.errors import BadArtifact
from industnerf.methods import load_method
from industnerf.report.costs import CostRow
from industnerf.report.formats import csv_rows
from industnerf.report.gather import Folders, Lesson, Study
from industnerf.report.given import Views, views_of
from industnerf.report.goals import with_the_rigs
from industnerf.report.results import Results
from industnerf.report.spread_shown import with_spread
from industnerf.report.table1 import STILL
from industnerf.schema import ReportParams
from industnerf.store import Cost

Cells = dict[str, str]


def reread_study(folder: Path, parts: Iterable[Part]) -> Results:
    """The results published in `folder`, over those of `parts` that it scored."""
    params = read_yaml(folder / "params.yaml")  # which may be of an older schema
    settings = build(ReportParams, params["report"], str(folder / "params.yaml"))
    study = with_spread(_study(folder, params, parts), folder.parent / "seeds")
    results = Results.of(study, settings, _costs(folder))
    reached = with_the_rigs(results.reached, csv_rows(folder / "goals.csv"))
    return replace(results, reached=reached)


def _study(folder: Path, params: Mapping[str, Any], parts: Iterable[Part]) -> Study:
    scores = csv_rows(folder / "scores.csv")
    rows = {row["method"]: row for row in csv_rows(folder / "table1.csv")}
    return Study(
        preset=params["preset"],
        seed=params["seed"],
        views=params["reconstruct"]["views"] or params["views"]["count"],
        methods={name: load_method(name) for name in params["methods"]},
        parts=_those(parts, {row["part_id"] for row in scores}),
        places={row["part_id"]: Place(row["split"], None) for row in scores},
        scores=[_score(row) for row in scores],
        failures={},
        remarks={},
        training={name: (int(row["parameters"]), int(row["steps"])) for name, row in rows.items()},
        lessons={name: _lesson(row) for name, row in rows.items() if int(row["learned_from"])},
        seen_by_training={},
        seen_by_rig={},
        folders=Folders(*[folder / "unpublished"] * 8),
        given=_given(params),
        seeds_sd={},
        empty_answers=_empty_answers(folder),
    )


def _empty_answers(folder: Path) -> dict[tuple[str, str], int]:
    """None in a table of before it had that column."""
    rows = csv_rows(folder / "table1.csv")
    known = [row for row in rows if row.get("empty_answers")]
    return {(row["method"], row["split"]): int(row["empty_answers"]) for row in known}


def _given(params: Mapping[str, Any]) -> dict[str, Views]:
    count = params["reconstruct"]["views"] or params["views"]["count"]
    settings = SimpleNamespace(
        **{name: SimpleNamespace(**values) for name, values in params["method"].items()}
    )
    return {name: views_of(load_method(name), count, settings) for name in params["methods"]}


def _those(parts: Iterable[Part], wanted: set[str]) -> dict[str, Part]:
    found = {part.part_id: part for part in parts if part.part_id in wanted}
    if missing := sorted(wanted - set(found)):
        raise BadArtifact(f"{len(missing)} scored parts are not in the catalogue: {missing[0]}")
    return found


def _score(row: Cells) -> PartScore:
    names = ("metric", "protocol", "value", "floor", "unit", "status")
    metric, protocol, value, floor, unit, status = (row[name] for name in names)
    score = Score(metric, protocol, float(value), float(floor), unit, status)
    return PartScore(row["part_id"], row["method"], score)


def _lesson(row: Cells) -> Lesson:
    settled = STILL not in row["undertrained"]
    return Lesson(row["size"], int(row["learned_from"]), row["hold_out"], settled)


def _costs(folder: Path) -> list[CostRow]:
    return [
        CostRow(row["stage"], row["method"], row["part_id"], _cost(row))
        for row in csv_rows(folder / "cost.csv")
    ]


def _cost(row: Cells) -> Cost:
    seconds, peak_mb, aside_s = (float(row[name]) for name in ("seconds", "peak_mb", "aside_s"))
    return Cost(seconds, peak_mb, row["device"], aside_s)
