"""What `dvc metrics` and `dvc plots` read: a few numbers a method, and the rows of three plots.

    metrics/<method>.json      EMD, floor, ratio, failures, seconds
    plots/emd.csv              EMD of every part
    plots/pareto.csv           EMD over seconds
    plots/curves.csv           loss over optimization steps

All are of the test parts, or of the dev parts where there are no others.
"""

import json
from collections import defaultdict
from collections.abc import Iterator
from itertools import islice
from statistics import median

from industnerf.artifacts.history import History
from industnerf.methods.base import Role
from industnerf.report.figures.pareto import pareto_front
from industnerf.report.results import Results
from industnerf.report.study import Study
from industnerf.report.tables.formats import csv_text
from industnerf.report.tables.scores import EMD_EVEN, scores_of, select_scores
from industnerf.stage import read_index

CURVES = "plots/curves.csv"
MAX_CURVE_POINTS = 100  # of a curve: every so many steps, and the last
MAX_CURVE_PARTS = 50  # whose median is a method's curve


def dvc_file_texts(results: Results) -> dict[str, str]:
    """The text of every file that needs no more than `results`, by its name in the report."""
    rows = [
        (row, extra)
        for row, extra in zip(results.table1, results.table1_extras, strict=True)
        if row.split == results.table1[0].split
    ]
    texts = {}
    for row, extra in rows:
        values = {
            "emd": _rounded(row.emd_even),
            "emd_ratio": _rounded(row.ratio_to_floor),
            "floor": _rounded(row.floor),
            "failures": row.failures,
            "seconds": _rounded(extra.seconds),  # null where the store does not know them
        }
        texts[f"metrics/{row.method}.json"] = json.dumps(values, indent=1) + "\n"
    emd_rows = [
        (score.part_id, score.method, score.score.value, score.score.floor)
        for row, _ in rows
        for score in select_scores(scores_of(results.study, row.method, row.split), *EMD_EVEN)
    ]
    texts["plots/emd.csv"] = csv_text(["part_id", "method", "emd", "floor"], emd_rows)
    points = [(extra.seconds, row.emd_even, row.method, extra.role) for row, extra in rows]
    front = pareto_front([(s, emd) for s, emd, _, role in points if s and role == Role.METHOD])
    pareto_rows = [
        (method, seconds, emd, role.value, "yes" if (seconds, emd) in front else "no")
        for seconds, emd, method, role in points
        if seconds
    ]
    texts["plots/pareto.csv"] = csv_text(["method", "seconds", "emd", "role", "front"], pareto_rows)
    return texts


def curves_csv(study: Study) -> str:
    """`plots/curves.csv`: the loss of every network, and the median one of methods by part."""
    rows = [
        (method, curve, step, loss)
        for method in study.methods
        for curve, points in _curves(study, method)
        for step, loss in _thinned(points)
    ]
    return csv_text(["method", "curve", "step", "loss"], rows)


def _curves(study: Study, method: str) -> Iterator[tuple[str, list[tuple[int, float]]]]:
    states, clouds = study.folders.states / method, study.folders.clouds / method
    for net in read_index(states) if states.is_dir() else {}:
        for folder, name in (
            (states / net, net),
            (states / net / "validation", f"{net}, held out"),
        ):
            if history := History.load(folder, "train"):
                yield name, _points(history)
    losses = defaultdict[int, list[float]](list)
    for part_id in islice(read_index(clouds), MAX_CURVE_PARTS):
        if history := History.load(clouds / part_id):
            for step, loss in _points(history):
                losses[step].append(loss)
    if losses:
        yield "median part", [(step, median(values)) for step, values in sorted(losses.items())]


def _points(history: History) -> list[tuple[int, float]]:
    return list(zip(history.steps.tolist(), history.loss.tolist(), strict=True))


def _thinned(points: list[tuple[int, float]]) -> list[tuple[int, float]]:
    every = -(-len(points) // MAX_CURVE_POINTS)
    return [*points[:-1:every], points[-1]] if points else []


def _rounded(value: float | None) -> float | None:
    """`value` with six significant digits."""
    return None if value is None else float(f"{value:.6g}")
