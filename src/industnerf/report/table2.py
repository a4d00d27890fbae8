"""Table 2: what a method's renderings of the held-out views are worth, and its confidence."""

from dataclasses import dataclass
from statistics import fmean

from industnerf.artifacts.scores import PartScore
from industnerf.report import paper
from industnerf.report.gather import Study
from industnerf.report.statistics import bootstrap_interval
from industnerf.report.tables import markdown, scores_of
from industnerf.schema import ReportParams
from industnerf.seeds import generator

LEFT_OUT = "Table 2 is left out: no method of this study renders the held-out views."


@dataclass(frozen=True)
class Loss:
    """One line of a method: the paper's three in its words, and what belongs beside them."""

    name: str
    metric: str
    protocol: str
    digits: int


LOSSES = (
    Loss("Point Cloud (EMD)", "emd", "P1-even", 4),
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
    """One loss of one method over the parts of one split that have it."""

    method: str
    split: str
    loss: Loss
    mean: float
    ci_low: float
    ci_high: float
    frame: float | None  # over the whole frame, of what has a mean over it
    best: float  # the floor, or the value that nothing beats
    paper: float | None
    parts: int
    failures: int  # in the mean of the EMD, in no other


def table2(study: Study, settings: ReportParams) -> list[Line]:
    """The lines of every method that renders, reported parts first; empty if none does."""
    renders = {row.method for row in study.scores if row.score.metric == "rgb_mse"}
    return [
        _line(study, settings, loss, mine, scores)
        for split in ("test", "dev")
        for name in study.methods
        if name in renders and (scores := scores_of(study, name, split))
        for loss in LOSSES
        if (mine := _only(scores, loss.metric, loss.protocol))
    ]


def _only(scores: list[PartScore], metric: str, protocol: str) -> list[PartScore]:
    return [row for row in scores if (row.score.metric, row.score.protocol) == (metric, protocol)]


def _line(
    study: Study,
    settings: ReportParams,
    loss: Loss,
    mine: list[PartScore],
    scores: list[PartScore],
) -> Line:
    values = [row.score.value for row in mine]
    low, high = bootstrap_interval(
        values,
        [study.parts[row.part_id].family for row in mine],
        settings.resamples,
        settings.interval,
        generator(study.seed, "bootstrap"),
    )
    frames = _only(scores, loss.metric, "P1-frame")
    return Line(
        mine[0].method,
        study.places[mine[0].part_id].split,
        loss,
        fmean(values),
        low,
        high,
        fmean(row.score.value for row in frames) if frames else None,
        fmean(row.score.floor for row in mine),
        paper.TABLE2.get(loss.metric),
        len(mine),
        sum(row.score.status != "ok" for row in _only(scores, "emd", "P1-even")),
    )


COLUMNS = (
    "method",
    "loss",
    "split",
    "score",
    "95 %",
    "whole frame",
    "best",
    "paper",
    "parts",
    "failed",
)


def cells(line: Line) -> list[str]:
    """`line` as people read it, one text for each of COLUMNS."""
    digits = line.loss.digits

    def short(value: float | None) -> str:
        return "" if value is None else f"{value:.{digits}f}"

    return [
        line.method,
        line.loss.name,
        line.split,
        short(line.mean),
        f"{short(line.ci_low)} to {short(line.ci_high)}",
        short(line.frame),
        short(line.best),
        "" if line.paper is None else str(line.paper),
        str(line.parts),
        str(line.failures),
    ]


def table2_md(lines: list[Line], interval: float) -> str:
    """`table2.md`: the table, or why there is none."""
    if not lines:
        return f"{LEFT_OUT}\n"
    return markdown(COLUMNS, [cells(line) for line in lines], interval)


def means(lines: list[Line]) -> dict[str, float]:
    """`method.split.metric` -> mean, of all that Table 1 does not have."""
    return {
        f"{line.method}.{line.split}.{line.loss.metric}": line.mean
        for line in lines
        if line.loss.metric != "emd"
    }
