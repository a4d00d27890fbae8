"""What each addition of `industnerf_plus` earns: from a sweep to docs/reference/method.md."""

import re
from statistics import fmean
from typing import Any

from industnerf.errors import BadArtifact
from industnerf.report.sweeps.ablation_effects import PointScores, format_difference
from industnerf.report.tables.formats import label_intervals, markdown_table
from industnerf.schema import ReportParams

METHODS = ("industnerf_plus",)
HEADS = [
    "changed",
    "EMD even",
    "more than with all",
    "95 %",
    "worse on",
    "failed",
    "RGB MSE",
    "RGB worse on",
]


def ablation_table(
    points: list[PointScores], default_settings: dict[str, Any], settings: ReportParams
) -> str:
    """A row for every point of the sweep, by how much worse it is than with all additions.

    `usual` are the settings with all of them, by dotted key.  Raises BadArtifact if no point has
    just these: there is nothing to compare with.

    RGB MSE is of the parts that did not fail: of the others there are no pictures.
    """
    by_change = {describe_changes(point.settings, default_settings): point for point in points}
    baseline = by_change.pop("", None)
    if baseline is None:
        raise BadArtifact(
            "no finished point has the settings of params.yaml; were they changed after the sweep?"
        )
    baseline_row = [
        "nothing",
        _mean(baseline.emd, 4),
        "",
        "",
        "",
        str(baseline.num_failed),
        _mean(baseline.rgb_mse, 5),
    ]
    rows = [[*baseline_row, ""]]
    ranked = sorted(by_change.items(), key=lambda item: -fmean(item[1].emd.values()))
    rows += [_row(name, point, baseline, settings) for name, point in ranked]
    return markdown_table(label_intervals(HEADS, settings.confidence_level), rows)


def describe_changes(settings: dict[str, Any], default_settings: dict[str, Any]) -> str:
    """What is not as usual, as Markdown; empty if all is."""
    values = [
        f"`{k}: {v}`"
        for k, v in settings.items()
        if k not in default_settings or v != default_settings[k]
    ]
    missing = [re.sub(r"\].*", "]", key) for key in default_settings if key not in settings]
    return ", ".join([*values, *(f"no `{key}`" for key in dict.fromkeys(missing))])


def _row(name: str, point: PointScores, baseline: PointScores, settings: ReportParams) -> list[str]:
    return [
        name,
        _mean(point.emd, 4),
        *format_difference(point, baseline, settings),
        _count_worse(point.emd, baseline.emd),
        str(point.num_failed),
        _mean(point.rgb_mse, 5),
        _count_worse(point.rgb_mse, baseline.rgb_mse),
    ]


def _mean(values: dict[str, float], digits: int) -> str:
    return f"{fmean(values.values()):.{digits}f}" if values else ""


def _count_worse(values: dict[str, float], baseline: dict[str, float]) -> str:
    parts = values.keys() & baseline.keys()
    return (
        f"{sum(values[part] > baseline[part] for part in parts)} of {len(parts)}" if parts else ""
    )
