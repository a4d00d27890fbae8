"""What single changes cost, from the points of a sweep.

Each reading of the paper for docs/reference/readings.md, each addition of `industnerf_plus` for
docs/reference/method.md.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import fmean
from typing import Any, get_args, get_type_hints

from industnerf.config import flatten, read_yaml
from industnerf.errors import BadArtifact
from industnerf.report.statistics.significance import BOOTSTRAP_SEED, paired_change
from industnerf.report.tables.formats import (
    format_interval,
    label_intervals,
    markdown_table,
    read_csv,
)
from industnerf.report.tables.scores import EMD_EVEN
from industnerf.schema import ReportParams
from industnerf.schema.readings import Readings

READING_METHODS = ("industnerf", "industnerf_shared")  # the second: reading `pretrained` of R14
READING_HEADERS = ["id", "reading", "EMD even", "less the default's", "95 %", "parts", "failed"]
ADDITION_METHODS = ("industnerf_plus",)
ADDITION_HEADERS = [
    *("changed", "EMD even", "more than with all", "95 %", "worse on", "failed", "RGB MSE"),
    *("RGB worse on", "processor s"),
]
NOT_MEASURED = "not yet measured"
RGB_MSE = ("rgb_mse", "P1-union")


@dataclass(frozen=True)
class PointScores:
    """Scores of a method under one set of settings."""

    settings: dict[str, Any]  # by dotted key
    emd: dict[str, float]  # part id -> EMD (even)
    families: dict[str, str]
    num_failed: int
    rgb_mse: dict[str, float] = field(default_factory=dict)  # part id -> RGB MSE
    cpu_seconds: dict[str, float] = field(default_factory=dict)  # part id -> to reconstruct it


def read_point_scores(sweep: Path, methods: Sequence[str] = READING_METHODS) -> list[PointScores]:
    """The finished points of the sweep in a folder, each of the first of `methods` that it ran.

    Raises BadArtifact if there is none.
    """
    points = [path.parent.parent for path in sorted(sweep.glob("*/reports/scores.csv"))]
    if not points:
        raise BadArtifact(f"{sweep} holds no finished point; the same sweep goes on")
    return [_read_point(point, methods) for point in points]


def _read_point(point: Path, methods: Sequence[str]) -> PointScores:
    params = read_yaml(point / "params.yaml")
    method = next((name for name in methods if name in params["methods"]), None)
    if method is None:
        raise BadArtifact(f"{point} ran none of {', '.join(methods)}")
    method_rows = [
        row for row in read_csv(point / "reports" / "scores.csv") if row["method"] == method
    ]
    emd_rows = [row for row in method_rows if (row["metric"], row["protocol"]) == EMD_EVEN]
    rgb_rows = [row for row in method_rows if (row["metric"], row["protocol"]) == RGB_MSE]
    cost_rows = [
        row
        for row in read_csv(point / "reports" / "cost.csv")
        if (row["stage"], row["method"]) == ("reconstruct", method)
    ]
    return PointScores(
        flatten(params["method"][method], split_lists=True),
        {row["part_id"]: float(row["value"]) for row in emd_rows},
        {row["part_id"]: row["family"] for row in emd_rows},
        sum(row["status"] != "ok" for row in emd_rows),
        {row["part_id"]: float(row["value"]) for row in rgb_rows},
        {row["part_id"]: float(row["cpu_seconds"]) for row in cost_rows},
    )


def readings_table(
    points: list[PointScores],
    default: Readings,
    reading_ids: dict[str, str],
    settings: ReportParams,
) -> str:
    """A row for every value of every reading: mean EMD, and mean paired difference to the default.

    `reading_ids` maps names to numbers such as R1. A point that changes several readings is not
    used.
    """
    defaults = vars(default)
    by_change = {_single_change(point.settings, defaults): point for point in points}
    baseline = by_change.get(("", ""))
    rows = []
    for name in defaults:
        for value in _ordered(name, defaults[name]):
            point = baseline if value == defaults[name] else by_change.get((name, value))
            cells = _reading_cells(point, baseline, settings)
            rows.append([reading_ids[name], f"`{value}`", *cells])
    return markdown_table(label_intervals(READING_HEADERS, settings.confidence_level), rows)


def _ordered(name: str, default: str) -> list[str]:
    values = get_args(get_type_hints(Readings)[name])
    return sorted(values, key=lambda value: value != default)


def _single_change(settings: dict[str, Any], defaults: dict[str, str]) -> tuple[str, str] | None:
    """The one changed reading and its value; two empty texts if none is, None if several are.

    Raises BadArtifact if the sweep is older than one of the readings.
    """
    if missing := [name for name in defaults if f"readings.{name}" not in settings]:
        raise BadArtifact(f"the sweep was run before {missing[0]} was a reading: run it anew")
    current = {name: settings[f"readings.{name}"] for name in defaults}
    changed = [(name, value) for name, value in current.items() if value != defaults[name]]
    return ("", "") if not changed else changed[0] if len(changed) == 1 else None


def _reading_cells(
    point: PointScores | None, baseline: PointScores | None, settings: ReportParams
) -> list[str]:
    if point is None:
        return [NOT_MEASURED, "", "", "", ""]
    is_compared = baseline is not None and point is not baseline
    difference = format_difference(point, baseline, settings) if is_compared else ["", ""]
    return [
        f"{fmean(point.emd.values()):.4f}",
        *difference,
        str(len(point.emd)),
        str(point.num_failed),
    ]


def format_difference(
    point: PointScores, baseline: PointScores, settings: ReportParams
) -> list[str]:
    """The mean paired difference of `point` to `baseline`, and its interval, as text."""
    change = paired_change(baseline.emd, point.emd, baseline.families, settings, BOOTSTRAP_SEED)
    if change is None:
        return ["", ""]
    return [f"{change.mean:+.4f}", format_interval(change.low, change.high, "+.4f")]


def ablation_table(
    points: list[PointScores], default_settings: dict[str, Any], settings: ReportParams
) -> str:
    """A row for every point, the worst first, against the point with `default_settings`.

    Settings are by dotted key. RGB MSE and processor seconds are means over the parts that did not
    fail. Raises BadArtifact if no point has the default settings.
    """
    by_change = {describe_changes(point.settings, default_settings): point for point in points}
    baseline = by_change.pop("", None)
    if baseline is None:
        raise BadArtifact(
            "no finished point has the settings of params.yaml; were they changed after the sweep?"
        )
    emd, rgb_mse = _mean(baseline.emd, 4), _mean(baseline.rgb_mse, 5)
    cpu_seconds = _mean(baseline.cpu_seconds, 1)
    rows = [["nothing", emd, "", "", "", str(baseline.num_failed), rgb_mse, "", cpu_seconds]]
    ranked = sorted(by_change.items(), key=lambda item: -fmean(item[1].emd.values()))
    rows += [_addition_row(name, point, baseline, settings) for name, point in ranked]
    return markdown_table(label_intervals(ADDITION_HEADERS, settings.confidence_level), rows)


def describe_changes(settings: dict[str, Any], default_settings: dict[str, Any]) -> str:
    """The settings that differ from the default, as Markdown; empty if none does."""
    values = [
        f"`{k}: {v}`"
        for k, v in settings.items()
        if k not in default_settings or v != default_settings[k]
    ]
    missing = [re.sub(r"\].*", "]", key) for key in default_settings if key not in settings]
    return ", ".join([*values, *(f"no `{key}`" for key in dict.fromkeys(missing))])


def _addition_row(
    name: str, point: PointScores, baseline: PointScores, settings: ReportParams
) -> list[str]:
    return [
        name,
        _mean(point.emd, 4),
        *format_difference(point, baseline, settings),
        _count_worse(point.emd, baseline.emd),
        str(point.num_failed),
        _mean(point.rgb_mse, 5),
        _count_worse(point.rgb_mse, baseline.rgb_mse),
        _mean(point.cpu_seconds, 1),
    ]


def _mean(values: dict[str, float], digits: int) -> str:
    return f"{fmean(values.values()):.{digits}f}" if values else ""


def _count_worse(values: dict[str, float], baseline: dict[str, float]) -> str:
    parts = values.keys() & baseline.keys()
    return (
        f"{sum(values[part] > baseline[part] for part in parts)} of {len(parts)}" if parts else ""
    )
