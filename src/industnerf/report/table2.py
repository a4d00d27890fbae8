"""Table 2: what a method's renderings of the held-out views are worth, and its confidence.

The paper scores in its Table 2 what its Figure 3 shows (section 4.6.2), yet the EMD there is that
of its Table 1, of all parts.  So both stand here: all test parts, and the subset `figure3`.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from statistics import fmean

from industnerf.artifacts.scores import PartScore
from industnerf.report import paper
from industnerf.report.formats import (
    brief,
    csv_text,
    interval_text,
    intervals_of,
    markdown,
    short,
)
from industnerf.report.gather import Study
from industnerf.report.lookup import EVEN, only, scores_of
from industnerf.report.millimetres import InMm, mean_in_mm
from industnerf.report.statistics import bootstrap_interval
from industnerf.report.subsets import figure3
from industnerf.schema import ReportParams

LEFT_OUT = (
    "Table 2 is left out: there is no rendering of a held-out view, for no method renders them, "
    "there are none, or all parts failed."
)


@dataclass(frozen=True)
class Loss:
    """One line of a method: the paper's three in its words, and what belongs beside them."""

    name: str
    metric: str
    protocol: str
    digits: int


LOSSES = (
    Loss("Point Cloud (EMD)", *EVEN, 4),
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
class Line:
    """One loss of one method over the parts of one subset that have it."""

    method: str
    subset: str  # all: the test parts; figure3: one of them a family; dev: those tuned on
    loss: Loss
    unit: str
    mean: float
    ci_low: float
    ci_high: float
    frame: float | None  # over the whole frame, of what has a mean over it
    best: float  # the floor, or the value that nothing beats
    paper: float | None
    parts: int
    families: int
    failures: int  # in the mean of the EMD, in no other
    in_mm: InMm | None  # of what is a length


def table2(study: Study, settings: ReportParams) -> list[Line]:
    """The lines of every method that renders, reported parts first; empty if none does."""
    renders = {row.method for row in study.scores if row.score.metric == "rgb_mse"}
    shown = figure3(study)
    return [
        _line(study, settings, subset, loss, mine, scores)
        for subset in ("all", "figure3", "dev")
        for name in study.methods
        if name in renders and (scores := _scores(study, name, subset, shown))
        for loss in LOSSES
        if (mine := only(scores, loss.metric, loss.protocol))
    ]


def _scores(study: Study, method: str, subset: str, shown: set[str]) -> list[PartScore]:
    scores = scores_of(study, method, "dev" if subset == "dev" else "test")
    return [row for row in scores if subset != "figure3" or row.part_id in shown]


def _line(
    study: Study,
    settings: ReportParams,
    subset: str,
    loss: Loss,
    mine: list[PartScore],
    scores: list[PartScore],
) -> Line:
    values = [row.score.value for row in mine]
    families = [study.parts[row.part_id].family for row in mine]
    low, high = bootstrap_interval(values, families, settings, study.seed)
    frames = only(scores, loss.metric, "P1-frame")
    return Line(
        mine[0].method,
        subset,
        loss,
        mine[0].score.unit,
        fmean(values),
        low,
        high,
        fmean(row.score.value for row in frames) if frames else None,
        fmean(row.score.floor for row in mine),
        paper.TABLE2.get(loss.metric) if mine[0].method == paper.METHOD else None,
        len(mine),
        len(set(families)),
        sum(row.score.status != "ok" for row in only(scores, *EVEN)),
        mean_in_mm(study, settings, mine),
    )


COLUMNS = (
    "method",
    "loss",
    "subset",
    "score",
    "95 %",
    "mm",
    "whole frame",
    "best",
    "paper",
    "parts",
    "failed",
)


def cells(line: Line) -> list[str]:
    """`line` as people read it, one text for each of COLUMNS."""
    digits = line.loss.digits
    return [
        line.method,
        line.loss.name,
        line.subset,
        short(line.mean, digits),
        interval_text(line.ci_low, line.ci_high, line.families, f".{digits}f"),
        _in_mm(line.in_mm),
        short(line.frame, digits),
        short(line.best, digits),
        "" if line.paper is None else str(line.paper),
        str(line.parts),
        str(line.failures),
    ]


def _in_mm(found: InMm | None) -> str:
    """The mean; if it is of squares, with its unit."""
    if found is None:
        return ""
    return brief(found.mean) + (" mm²" if found.unit == "mm^2" else "")


def table2_md(lines: list[Line], interval: float) -> str:
    """`table2.md`: the table, or why there is none."""
    if not lines:
        return f"{LEFT_OUT}\n"
    return markdown(intervals_of(COLUMNS, interval), [cells(line) for line in lines])


CSV_COLUMNS = ("method", "subset", "loss", "value", "ci_low", "ci_high", "unit", "paper")


def table2_csv(lines: list[Line]) -> str:
    """`table2.csv`: the paper's three losses of the reported parts, its own number beside each.

    Below a loss that is a length stands the same in mm; the paper has no such number.  Of one
    family there is no interval.
    """
    shown = [line for line in lines if line.subset != "dev" and line.loss.metric in paper.TABLE2]
    return csv_text(CSV_COLUMNS, [row for line in shown for row in _csv_rows(line)])


def _csv_rows(line: Line) -> Iterator[tuple]:
    name, mm = (line.method, line.subset, line.loss.metric), line.in_mm
    yield (*name, line.mean, *_ends(line, line.families), line.unit, line.paper)
    if mm:
        yield (*name, mm.mean, *_ends(mm, line.families), mm.unit, None)


def _ends(mean: Line | InMm, families: int) -> tuple[float, float] | tuple[None, None]:
    return (mean.ci_low, mean.ci_high) if families > 1 else (None, None)


def means(lines: list[Line]) -> dict[str, float]:
    """`method.split.metric` -> mean over a whole split, of all that Table 1 does not have."""
    splits = {"all": "test", "dev": "dev"}
    return {
        f"{line.method}.{splits[line.subset]}.{line.loss.metric}": line.mean
        for line in lines
        if line.subset in splits and line.loss.metric != "emd"
    }
