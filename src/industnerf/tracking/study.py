"""A report as a run of MLflow: the study, below it a run per method, below that one per fold."""

import colorsys
import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any

from industnerf.artifacts.split import SplitAssignment, load_split, train_parts
from industnerf.config import flatten
from industnerf.stage import read_index
from industnerf.store import content_digest
from industnerf.tracking.history import loss_curve
from industnerf.tracking.preview import preview_image
from industnerf.tracking.run import Dataset, Run
from industnerf.tracking.scores import (
    TABLE1_NAMES,
    mean_scores,
    part_table,
    read_costs,
    read_part_scores,
    read_table1,
)
from industnerf.tracking.tags import load_tags

PART_CURVES = ("emd", "emd_ratio", "chamfer", "fscore", "seconds")  # drawn part by part
MAX_CURVE_PARTS = 1000  # of more, every so-manieth is drawn; the table has all
SHARED_SECTIONS = ("seed", "views", "reconstruct")  # parameters that every method depends on
GOLDEN_RATIO = 0.618034  # of the hues: neighbors are far apart, however many there are
LEARNING_SECTIONS = ("split", "pretrain", "train")  # and those that a method of another scope does


@dataclass(frozen=True)
class Report:
    """The report in `folder`, made with `params`."""

    folder: Path
    params: Mapping[str, Any]

    @cached_property
    def results(self) -> str:
        """A digest that reports with the same scores share."""
        return content_digest([self.folder / "table1.csv", self.folder / "scores.csv"])

    @cached_property
    def scores(self) -> Any:
        return read_part_scores(self.folder)

    @cached_property
    def table1(self) -> Any:
        return read_table1(self.folder)

    @cached_property
    def training_costs(self) -> Any:
        return read_costs(self.folder, "train")

    @cached_property
    def tags(self) -> dict[str, str]:
        """Those of every run of the report."""
        known = {"preset": str(self.table1.preset[0]), "results": self.results}
        return known | load_tags(self.folder)

    @cached_property
    def split(self) -> str:
        """The parts whose means are the metrics: dev where there are no test parts."""
        return "test" if (self.scores.split == "test").any() else "dev"

    @property
    def data(self) -> Path:
        """What the stages before the report wrote; published results have none."""
        return self.folder.parent / "data"

    @cached_property
    def assignments(self) -> dict[str, SplitAssignment]:
        path = self.data / "split.json"
        return load_split(path) if path.exists() else {}

    @cached_property
    def part_keys(self) -> dict[str, list[str]]:
        """The store's keys of the mesh and the photographs of every part, where known."""
        folders = [self.data / name for name in ("parts", "views")]
        indices = [read_index(path) for path in folders if (path / "index.json").exists()]
        return {part: [index.get(part, "") for index in indices] for part in self.families}

    @cached_property
    def families(self) -> dict[str, str]:
        return dict(zip(self.scores.part_id, self.scores.family, strict=True))

    def methods(self) -> list[str]:
        """The method of the smallest EMD first."""
        return list(self.table1[self.table1.split == self.split].method)

    def dataset(self, parts: list[str], context: str) -> Dataset:
        """`parts` as a dataset, told from others by their meshes and photographs."""
        source = str(self.params.get("parts", {}).get("path", "unknown"))
        content = json.dumps([(part, self.part_keys[part]) for part in sorted(parts)])
        digest = hashlib.sha256(content.encode()).hexdigest()[:16]
        num_families = len({self.families[part] for part in parts})
        return Dataset(Path(source).name, context, digest, source, len(parts), num_families)


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
        part_table(rows),
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
