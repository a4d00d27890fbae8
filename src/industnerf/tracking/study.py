"""A report as a run of MLflow: the study, below it a run per method, below that one per fold."""

import colorsys
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from industnerf.artifacts.split import train_parts
from industnerf.config import flatten
from industnerf.tracking.loss_curve import loss_curve
from industnerf.tracking.preview import preview_image
from industnerf.tracking.report import Report
from industnerf.tracking.run import Run
from industnerf.tracking.scores import TABLE1_NAMES, mean_scores, part_table

PART_CURVES = ("emd", "emd_ratio", "chamfer", "fscore", "seconds")  # drawn part by part
MAX_CURVE_PARTS = 1000  # of more, every so-manieth is drawn; the table has all
SHARED_SECTIONS = ("seed", "views", "reconstruct")  # parameters that every method depends on
LEARNING_SECTIONS = ("split", "pretrain", "train")  # and those that learning ones do
GOLDEN_RATIO = 0.618034  # of the hues: neighbors are far apart, however many there are


def study_run(report: Report) -> Run:
    """The run of a study, with those of its methods below it."""
    params = {key: value for key, value in report.params.items() if key != "method"}
    return Run(
        report.tags["preset"],
        {**report.tags, "kind": "study"},
        flatten(params),
        artifacts=((report.folder, "report"),),
        children=(
            method_run(
                report, method, {"kind": "method", "mlflow.runColor": _color(report, method)}
            )
            for method in report.methods()
        ),
    )


def _color(report: Report, method: str) -> str:
    """A method's color in the charts, the same in all studies."""
    names = list(report.params.get("method", {}))
    hue = GOLDEN_RATIO * names.index(method) % 1 if method in names else 0.0
    red_green_blue = colorsys.hls_to_rgb(hue, 0.45, 0.7)
    return "#" + "".join(f"{round(255 * share):02x}" for share in red_green_blue)


def method_run(
    report: Report,
    method: str,
    tags: Mapping[str, str],
    swept: Mapping[str, Any] = MappingProxyType({}),
) -> Run:
    """The run of a method, with those of its folds below it.

    What was `swept` stands in its name and among its parameters.
    """
    rows = report.scores[report.scores.method == method]
    headline, others = rows[rows.split == report.split], rows[rows.split != report.split]
    table1 = report.table1[report.table1.method == method]
    own = table1[table1.split == report.split].iloc[0]
    metrics = mean_scores(headline)
    metrics |= {name: float(own[key]) for key, name in TABLE1_NAMES.items() if own[key] == own[key]}
    if len(others):
        metrics |= {f"dev/{name}": value for name, value in mean_scores(others).items()}
    training = report.training_costs[report.training_costs.method == method]
    if len(training):
        metrics["training_seconds"] = float(training.seconds.sum())
        metrics["training_peak_mb"] = float(training.peak_mb.max())
    clouds, states = (report.data / name / method for name in ("clouds", "states"))
    curves = {
        **_part_curves(headline),
        "loss/reconstruction": loss_curve(clouds),
        "loss/training": loss_curve(states),
        "loss/validation": loss_curve(states, "*/validation"),
    }
    shared_tags = {**report.tags, **tags, "split": report.split}
    shared_tags |= {"scope": own.scope, "inputs": own.inputs}
    params = {"method": method, **_own_params(report.params, method, own.scope), **swept}
    return Run(
        " ".join([method, *(f"{key}={value}" for key, value in swept.items())]),
        shared_tags,
        params,
        metrics,
        curves,
        part_table(headline, others),
        preview_image(clouds, report.data / "views"),
        datasets=tuple(
            report.dataset(list(group.part_id), group.split.iloc[0])
            for group in (headline, others)
            if len(group)
        ),
        children=[
            _fold_run(report, headline, row, {**shared_tags, "kind": "fold"})
            for row in training.itertuples()
            if row.part_id != "all"  # which is what the method's run is of
        ],
    )


def _own_params(params: Mapping[str, Any], method: str, scope: str) -> dict[str, Any]:
    """Those of one method without its name before them, and those that all methods share."""
    sections = SHARED_SECTIONS if scope == "part" else (*SHARED_SECTIONS, *LEARNING_SECTIONS)
    shared = {name: params[name] for name in sections if name in params}
    return flatten(shared) | flatten(params.get("method", {}).get(method, {}))


def _part_curves(rows: Any) -> dict[str, dict[int, float]]:
    """`part/<metric>`: its value at each step, which is the part's place in the table."""
    stride = -(-len(rows) // MAX_CURVE_PARTS)
    drawn = rows.assign(step=range(len(rows)))[::stride]
    return {
        f"part/{name}": drawn.set_index("step")[name].dropna().to_dict()
        for name in PART_CURVES
        if name in drawn
    }


def _fold_run(report: Report, rows: Any, training: Any, tags: Mapping[str, str]) -> Run:
    """One network: what it cost to train, and the scores of the parts that it was asked about."""
    fold, state = training.part_id, report.data / "states" / training.method / training.part_id
    assignments = report.assignments
    tested = [part for part, one in assignments.items() if one.net_name == fold]
    own_rows = rows[rows.part_id.isin(tested)]
    learned_from = [part for part in train_parts(assignments, fold) if part in report.families]
    metrics = {
        "training_seconds": float(training.seconds),
        "training_peak_mb": float(training.peak_mb),
    }
    datasets = [report.dataset(learned_from, "training")] if learned_from else []
    if len(own_rows):
        metrics |= mean_scores(own_rows)
        datasets.append(report.dataset(list(own_rows.part_id), report.split))
    return Run(
        f"{training.method} {fold}",
        {**tags, "fold": fold},
        {"method": training.method, "fold": fold},
        metrics,
        {
            "loss/training": loss_curve(state.parent, fold),
            "loss/validation": loss_curve(state.parent, f"{fold}/validation"),
        },
        datasets=tuple(datasets),
    )
