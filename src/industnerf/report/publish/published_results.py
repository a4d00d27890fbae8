"""A published study read back, so that its tables can be rebuilt from its scores.

What is not published stays empty: reasons of failures, input warnings, visible shares. The goal
that needs the share seen by the reference rig is the published one.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from industnerf.artifacts.part import Part
from industnerf.artifacts.scores import PartScore, Score
from industnerf.artifacts.split import SplitAssignment
from industnerf.config import build, read_yaml
from industnerf.errors import BadArtifact
from industnerf.methods import load_method
from industnerf.methods.base import Input, Method
from industnerf.report.results import Results
from industnerf.report.statistics.seed_variance import add_seed_variance
from industnerf.report.study import InputViews, Study, StudyFolders, TrainingSummary, input_views_of
from industnerf.report.tables.costs import CostRow
from industnerf.report.tables.formats import optional_float, read_csv
from industnerf.report.tables.goals import add_capture_goals
from industnerf.report.tables.table1 import STILL_TRAINING
from industnerf.schema import ReportParams
from industnerf.store import Cost

CsvRow = dict[str, str]


def read_published_results(folder: Path, parts: Iterable[Part]) -> Results:
    """The results published in `folder`, over those of `parts` that it scored.

    Raises BadArtifact if a scored part is not among `parts`.
    """
    params = read_yaml(folder / "params.yaml")  # which may be of an older schema
    settings = build(ReportParams, params["report"], str(folder / "params.yaml"))
    study = add_seed_variance(_study(folder, params, parts), folder.parent / "seeds")
    results = Results.from_study(study, settings, _costs(folder))
    goals = add_capture_goals(results.goals, read_csv(folder / "goals.csv"))
    return replace(results, goals=goals)


def _study(folder: Path, params: Mapping[str, Any], parts: Iterable[Part]) -> Study:
    scores = read_csv(folder / "scores.csv")
    rows = {row["method"]: row for row in read_csv(folder / "table1.csv")}
    return Study(
        preset=params["preset"],
        seed=params["seed"],
        num_train_views=params["reconstruct"]["views"] or params["views"]["count"],
        methods={name: _method_as_run(name, rows[name]["inputs"]) for name in params["methods"]},
        parts=_select_parts(parts, {row["part_id"] for row in scores}),
        assignments={row["part_id"]: SplitAssignment(row["split"], None) for row in scores},
        scores=[_score(row) for row in scores],
        failures={},
        input_warnings={},
        parameters_and_steps={
            name: (int(row["parameters"]), int(row["steps"])) for name, row in rows.items()
        },
        training_summaries={
            name: _training_summary(row)
            for name, row in rows.items()
            if int(row["num_train_parts"])
        },
        train_visible_share={},
        rig_visible_share={},
        folders=StudyFolders.all_at(folder / "unpublished"),
        input_views=_input_views(params),
        seeds_sd={},
        empty_predictions=_empty_predictions(folder),
    )


def _method_as_run(name: str, label: str) -> Method:
    """The method with the inputs that it had then, as `inputs_label` wrote them."""
    names = label.partition(" (")[0].split(" + ")
    return replace(load_method(name), inputs=frozenset(map(Input, names)))


def _empty_predictions(folder: Path) -> dict[tuple[str, str], int]:
    """Empty where the table is older than the column."""
    rows = read_csv(folder / "table1.csv")
    known = [row for row in rows if row.get("empty_predictions")]
    return {(row["method"], row["split"]): int(row["empty_predictions"]) for row in known}


def _input_views(params: Mapping[str, Any]) -> dict[str, InputViews]:
    num_views = params["reconstruct"]["views"] or params["views"]["count"]
    settings = SimpleNamespace(
        **{name: SimpleNamespace(**values) for name, values in params["method"].items()}
    )
    return {
        name: input_views_of(load_method(name), num_views, settings) for name in params["methods"]
    }


def _select_parts(parts: Iterable[Part], part_ids: set[str]) -> dict[str, Part]:
    selected = {part.part_id: part for part in parts if part.part_id in part_ids}
    if missing := sorted(part_ids - set(selected)):
        raise BadArtifact(f"{len(missing)} scored parts are not in the catalogue: {missing[0]}")
    return selected


def _score(row: CsvRow) -> PartScore:
    names = ("metric", "protocol", "value", "floor", "unit", "status")
    metric, protocol, value, floor, unit, status = (row[name] for name in names)
    floor_se = optional_float(row.get("floor_se"))
    score = Score(metric, protocol, float(value), float(floor), unit, status, floor_se)
    return PartScore(row["part_id"], row["method"], score)


def _training_summary(row: CsvRow) -> TrainingSummary:
    has_converged = STILL_TRAINING not in row["undertrained"]
    return TrainingSummary(row["size"], int(row["num_train_parts"]), row["hold_out"], has_converged)


def _costs(folder: Path) -> list[CostRow]:
    return [
        CostRow(row["stage"], row["method"], row["part_id"], _cost(row))
        for row in read_csv(folder / "cost.csv")
    ]


def _cost(row: CsvRow) -> Cost:
    seconds, peak_mb, extra_seconds = (
        float(row[name]) for name in ("seconds", "peak_mb", "extra_seconds")
    )
    cpu = (optional_float(row.get(name)) for name in ("cpu_seconds", "extra_cpu_seconds"))
    return Cost(seconds, peak_mb, row["device"], extra_seconds, *cpu)
