"""Every method in millimeters, as inspection reports them.

Parts have very different sizes: large ones dominate a mean in mm, so medians stand beside it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean, median

from industnerf.artifacts.scores import PartScore
from industnerf.report.study import Study
from industnerf.report.tables.formats import csv_text, format_significant, markdown_table
from industnerf.report.tables.scores import EMD_EVEN, scores_of, select_scores, values_in_mm

WITHIN_PREFIX, COVERED_PREFIX = "within_", "covered_"  # of metrics; a tolerance follows


@dataclass(frozen=True)
class InspectionRow:
    """One method over the test parts, failures included; None where a metric was not measured."""

    method: str
    emd_mm: float
    emd_median_mm: float
    hausdorff95_mm: float | None
    hausdorff95_median_mm: float | None
    within: dict[str, float | None]  # tolerance -> share of the cloud's points
    covered: dict[str, float | None]  # tolerance -> share of the visible surface
    parts: int


def inspection_rows(study: Study) -> list[InspectionRow]:
    """A row per method, the smallest median EMD first."""
    metrics = list(dict.fromkeys(row.score.metric for row in study.scores))
    rows = [
        _inspection_row(study, method, scores, metrics)
        for method in study.methods
        if (scores := scores_of(study, method, "test"))
    ]
    return sorted(rows, key=lambda inspected: inspected.emd_median_mm)


def _inspection_row(
    study: Study, method: str, scores: list[PartScore], metrics: list[str]
) -> InspectionRow:
    even_scores = select_scores(scores, *EMD_EVEN)
    emds = values_in_mm(study, even_scores)
    hausdorffs = _metric_values(scores, "hausdorff95")
    return InspectionRow(
        method,
        fmean(emds),
        median(emds),
        fmean(hausdorffs) if hausdorffs else None,
        median(hausdorffs) if hausdorffs else None,
        _shares(scores, metrics, WITHIN_PREFIX),
        _shares(scores, metrics, COVERED_PREFIX),
        len(emds),
    )


def _shares(scores: list[PartScore], metrics: list[str], prefix: str) -> dict[str, float | None]:
    """By tolerance, the mean of the metrics whose names begin with `prefix`."""
    by_tolerance = {
        metric.removeprefix(prefix): _metric_values(scores, metric)
        for metric in metrics
        if metric.startswith(prefix)
    }
    return {
        tolerance: fmean(values) if values else None for tolerance, values in by_tolerance.items()
    }


def _metric_values(scores: list[PartScore], metric: str) -> list[float]:
    return [row.score.value for row in select_scores(scores, metric, "P1-dense")]


def inspection_csv(rows: Sequence[InspectionRow]) -> str:
    """`inspection.csv`, a column per field of InspectionRow and per tolerance."""
    fixed_columns = ("method", "emd_mm", "emd_median_mm", "hausdorff95_mm", "hausdorff95_median_mm")
    return csv_text(
        [
            *fixed_columns,
            *_tolerance_labels(rows, WITHIN_PREFIX + "{}", COVERED_PREFIX + "{}"),
            "parts",
        ],
        [
            [*(getattr(row, name) for name in fixed_columns), *_all_shares(row), row.parts]
            for row in rows
        ],
    )


def _tolerance_labels(rows: Sequence[InspectionRow], within: str, covered: str) -> list[str]:
    """A label for each of `_all_shares`, from the templates `within` and `covered`."""
    if not rows:
        return []
    first = rows[0]
    return [*map(within.format, first.within), *map(covered.format, first.covered)]


def _all_shares(row: InspectionRow) -> list[float | None]:
    return [*row.within.values(), *row.covered.values()]


def headers(rows: Sequence[InspectionRow]) -> list[str]:
    """The heads of the columns of `format_row`."""
    shares = _tolerance_labels(rows, "cloud within {}", "surface within {}")
    return [
        "method",
        "EMD, mm",
        "EMD, median",
        "Hausdorff-95, mm",
        "Hausdorff-95, median",
        *(share.replace("mm", " mm") for share in shares),
        "parts",
    ]


def format_row(row: InspectionRow) -> list[str]:
    """`row` as text, one for each of `headers`."""
    return [
        row.method,
        format_significant(row.emd_mm),
        format_significant(row.emd_median_mm),
        format_significant(row.hausdorff95_mm),
        format_significant(row.hausdorff95_median_mm),
        *("" if share is None else f"{100 * share:.1f} %" for share in _all_shares(row)),
        str(row.parts),
    ]


def inspection_md(rows: Sequence[InspectionRow]) -> str:
    """`inspection.md`."""
    return markdown_table(headers(rows), map(format_row, rows))
