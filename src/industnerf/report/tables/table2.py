"""Table 2: quality of the renderings of held-out views, and of the confidence.

The paper's Table 2 scores the parts of its Figure 3 (section 4.6.2), yet its EMD is that of
Table 1, of all parts. So both are here: all test parts, and the subset `figure3`.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from statistics import fmean

from industnerf.artifacts.scores import PartScore
from industnerf.report import paper_results
from industnerf.report.part_subsets import figure3_parts
from industnerf.report.statistics.significance import bootstrap_interval
from industnerf.report.study import Study
from industnerf.report.tables.formats import (
    csv_text,
    format_fixed,
    format_interval,
    format_significant,
    label_intervals,
    markdown_table,
)
from industnerf.report.tables.scores import (
    DEPTH_COVERAGE,
    EMD_EVEN,
    MeanInMm,
    mean_in_mm,
    scores_of,
    select_scores,
)
from industnerf.schema import ReportParams

NO_TABLE2 = (
    "Table 2 is left out: there is no rendering of a held-out view, for no method renders them, "
    "there are none, or all parts failed."
)


@dataclass(frozen=True)
class Loss:
    """One quantity of the table: the paper's three under its names, and ours."""

    name: str
    metric: str
    protocol: str
    digits: int


LOSSES = (
    Loss("Point Cloud (EMD)", *EMD_EVEN, 4),
    Loss("RGB 2D (MSE)", "rgb_mse", "P1-union", 5),
    Loss("Depth 2D (MSE)", "depth_mse", "P1-union", 6),
    Loss("depth: coverage", "coverage", "P1-union", 4),
    Loss("PSNR, dB", "psnr", "P1-union", 2),
    Loss("SSIM", "ssim", "P1-union", 4),
    Loss("silhouette IoU", "silhouette_iou", "P1-union", 4),
    Loss("confidence: rank correlation", "confidence_spearman", "P1-near", 3),
    Loss("confidence: AUSE", "confidence_ause", "P1-near", 3),
    Loss("confidence: AUSE by chance", "confidence_ause_chance", "P1-near", 3),
)


@dataclass(frozen=True)
class Table2Row:
    """One loss of one method over the parts of one subset that have it."""

    method: str
    subset: str  # all: the test parts; figure3: one of each family; dev: the dev parts
    loss: Loss
    unit: str
    mean: float
    ci_low: float | None  # None: one family has no interval
    ci_high: float | None
    whole_image: float | None  # the mean over whole images, where there is one
    best: float  # the floor of the EMD, or the best possible value
    paper: float | None
    parts: int
    families: int
    failures: int  # counted in the EMD alone
    mean_mm: MeanInMm | None  # of lengths
    coverage: float | None  # of a depth: mean share of the foreground that has one


def table2_rows(study: Study, settings: ReportParams) -> list[Table2Row]:
    """The rows of every method that renders, test parts first; empty if none does."""
    rendering_methods = {row.method for row in study.scores if row.score.metric == "rgb_mse"}
    figure3_ids = figure3_parts(study)
    return [
        _table2_row(study, settings, subset, loss, loss_scores, scores)
        for subset in ("all", "figure3", "dev")
        for name in study.methods
        if name in rendering_methods and (scores := _scores(study, name, subset, figure3_ids))
        for loss in LOSSES
        if (loss_scores := select_scores(scores, loss.metric, loss.protocol))
    ]


def _scores(study: Study, method: str, subset: str, figure3_ids: set[str]) -> list[PartScore]:
    scores = scores_of(study, method, "dev" if subset == "dev" else "test")
    return [row for row in scores if subset != "figure3" or row.part_id in figure3_ids]


def _table2_row(
    study: Study,
    settings: ReportParams,
    subset: str,
    loss: Loss,
    loss_scores: list[PartScore],
    scores: list[PartScore],
) -> Table2Row:
    values = [row.score.value for row in loss_scores]
    families = [study.parts[row.part_id].family for row in loss_scores]
    low, high = bootstrap_interval(values, families, settings, study.seed)
    whole_image_scores = select_scores(scores, loss.metric, "P1-frame")
    return Table2Row(
        loss_scores[0].method,
        subset,
        loss,
        loss_scores[0].score.unit,
        fmean(values),
        low,
        high,
        fmean(row.score.value for row in whole_image_scores) if whole_image_scores else None,
        fmean(row.score.floor for row in loss_scores),
        paper_results.TABLE2.get(loss.metric)
        if loss_scores[0].method == paper_results.METHOD
        else None,
        len(loss_scores),
        len(set(families)),
        sum(row.score.status != "ok" for row in select_scores(scores, *EMD_EVEN)),
        mean_in_mm(study, settings, loss_scores),
        _mean_coverage(scores) if loss.metric == "depth_mse" else None,
    )


def _mean_coverage(scores: list[PartScore]) -> float | None:
    """A depth is compared where there is one: pixels left out may make its error smaller."""
    rows = select_scores(scores, *DEPTH_COVERAGE)
    return fmean(row.score.value for row in rows) if rows else None


COLUMNS = (
    *("method", "loss", "subset", "score", "95 %", "mm", "whole frame", "best", "paper", "parts"),
    *("failed", "coverage"),
)


def format_row(row: Table2Row) -> list[str]:
    """`row` as text, one for each of COLUMNS."""
    digits = row.loss.digits
    return [
        row.method,
        row.loss.name,
        row.subset,
        format_fixed(row.mean, digits),
        format_interval(row.ci_low, row.ci_high, f".{digits}f"),
        _format_mm(row.mean_mm),
        format_fixed(row.whole_image, digits),
        format_fixed(row.best, digits),
        "" if row.paper is None else str(row.paper),
        str(row.parts),
        str(row.failures),
        format_fixed(row.coverage, 4),
    ]


def _format_mm(mean_mm: MeanInMm | None) -> str:
    """The mean; a squared one with its unit."""
    if mean_mm is None:
        return ""
    return format_significant(mean_mm.mean) + (" mm²" if mean_mm.unit == "mm^2" else "")


def table2_md(rows: list[Table2Row], interval: float) -> str:
    """`table2.md`: the table, or why there is none."""
    if not rows:
        return f"{NO_TABLE2}\n"
    return markdown_table(label_intervals(COLUMNS, interval), [format_row(row) for row in rows])


CSV_COLUMNS = (
    "method",
    "subset",
    "loss",
    "value",
    "ci_low",
    "ci_high",
    "unit",
    "paper",
    "coverage",
)


def table2_csv(rows: list[Table2Row]) -> str:
    """`table2.csv`: the paper's three losses on the test parts, beside the paper's numbers.

    Below a length stands the same in mm.
    """
    reported = [
        table_row
        for table_row in rows
        if table_row.subset != "dev" and table_row.loss.metric in paper_results.TABLE2
    ]
    return csv_text(CSV_COLUMNS, [row for table_row in reported for row in _csv_rows(table_row)])


def _csv_rows(row: Table2Row) -> Iterator[tuple]:
    key, mm = (row.method, row.subset, row.loss.metric), row.mean_mm
    yield (*key, row.mean, row.ci_low, row.ci_high, row.unit, row.paper, row.coverage)
    if mm:
        yield (*key, mm.mean, mm.ci_low, mm.ci_high, mm.unit, None, row.coverage)


def metric_means(rows: list[Table2Row]) -> dict[str, float]:
    """`method.split.metric` -> mean over a split, for all metrics that Table 1 lacks."""
    splits = {"all": "test", "dev": "dev"}
    return {
        f"{row.method}.{splits[row.subset]}.{row.loss.metric}": row.mean
        for row in rows
        if row.subset in splits and row.loss.metric != "emd"
    }
