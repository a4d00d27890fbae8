"""Table 1 (the paper's, with floors and intervals) and the scores behind it."""

from dataclasses import astuple, dataclass, fields, replace
from statistics import fmean

from industnerf.artifacts.scores import PartScore
from industnerf.methods.base import Method, Role
from industnerf.report import paper
from industnerf.report.formats import brief, csv_text, intervals_of, markdown, short
from industnerf.report.gather import Lesson, Study
from industnerf.report.lookup import EVEN
from industnerf.report.statistics import bootstrap_interval
from industnerf.schema import ReportParams
from industnerf.seeds import generator

MUST_BEAT = ("retrieval", "mean_shape")  # by a net that deserves its name


@dataclass(frozen=True)
class Row:
    """One method over the parts of one split."""

    method: str
    scope: str
    inputs: str
    split: str
    preset: str
    views: int
    emd_even: float
    ci_low: float
    ci_high: float
    floor: float
    ratio_to_floor: float
    emd_iid: float
    emd_full: float
    parts: int
    failures: int
    parameters: int
    steps: int
    paper_emd: float | None
    size: str  # of a net: full is as published
    learned_from: int  # parts, the fewest of any fold
    hold_out: str  # what those parts have not in common with the part asked for
    undertrained: str  # why a net does not deserve its name, or empty
    emd_mm: float  # EMD (even) of each part in mm, their mean


@dataclass(frozen=True)
class Extra:
    """What Table 1 shows beside its columns."""

    emd_without_failures: float | None
    seconds: float | None
    to_ours: float | None = None  # EMD (even) as a multiple of the paper's method's
    role: Role = Role.METHOD


def table1(study: Study, settings: ReportParams) -> list[Row]:
    """A row per split and method, reported parts first, best method first within a split."""
    rows = [
        _row(study, settings, method, split, scores)
        for split in ("test", "dev")
        for method in study.methods.values()
        if (scores := scores_of(study, method.name, split))
    ]
    marked = [replace(row, undertrained=undertrained(study, row, rows)) for row in rows]
    return sorted(marked, key=lambda row: (row.split != "test", row.emd_even))


def undertrained(study: Study, row: Row, rows: list[Row]) -> str:
    """Why the net of `row` is weaker than it should be; empty if it is not, or no net at all."""
    if not row.size:
        return ""
    why = [] if study.lessons[row.method].settled else ["still learning"]
    why += [
        f"no better than {other.method}"
        for other in rows
        if other.method in MUST_BEAT and other.split == row.split and other.emd_even <= row.emd_even
    ]
    return ", ".join(why)


def scores_of(study: Study, method: str, split: str) -> list[PartScore]:
    """The scores of `method` on the parts of `split`."""
    return [
        row
        for row in study.scores
        if row.method == method and study.places[row.part_id].split == split
    ]


def only(scores: list[PartScore], metric: str, protocol: str) -> list[PartScore]:
    """Those of `scores` that are of one metric under one protocol."""
    return [row for row in scores if (row.score.metric, row.score.protocol) == (metric, protocol)]


def _row(
    study: Study, settings: ReportParams, method: Method, split: str, scores: list[PartScore]
) -> Row:
    even = only(scores, *EVEN)
    values = [row.score.value for row in even]
    low, high = bootstrap_interval(
        values,
        [study.parts[row.part_id].family for row in even],
        settings.resamples,
        settings.interval,
        generator(study.seed, "bootstrap"),  # the same draws of families for every method
    )
    floor = fmean(row.score.floor for row in even)
    parameters, steps = study.training[method.name]
    return Row(
        method.name,
        method.scope.value,
        inputs_of(method),
        split,
        study.preset,
        study.views,
        fmean(values),
        low,
        high,
        floor,
        fmean(values) / floor,
        _mean(scores, "P1-iid"),
        _mean(scores, "P1-full"),
        len(even),
        sum(row.score.status != "ok" for row in even),
        parameters,
        steps,
        paper.EMD.get(method.name),
        *_learned(study.lessons.get(method.name)),
        "",
        fmean(row.score.value * study.parts[row.part_id].diagonal_mm for row in even),
    )


def _learned(lesson: Lesson | None) -> tuple[str, int, str]:
    return ("", 0, "") if lesson is None else (lesson.size, lesson.parts, lesson.hold_out)


def inputs_of(method: Method) -> str:
    """Declared inputs; a null or a bound says so, for its row is no competitor's."""
    names = " + ".join(sorted(method.inputs))
    return names if method.role == Role.METHOD else f"{names} ({method.role.value})"


def _mean(scores: list[PartScore], protocol: str) -> float:
    return fmean(row.score.value for row in only(scores, "emd", protocol))


def table1_csv(rows: list[Row]) -> str:
    """`table1.csv`, one column a field of Row."""
    lines = [
        [f"{cell:.6f}" if isinstance(cell, float) else cell for cell in astuple(row)]
        for row in rows
    ]
    return csv_text([field.name for field in fields(Row)], lines)


def without_failures(study: Study, row: Row) -> float | None:
    """Mean EMD (even) over the parts that did not fail."""
    even = only(scores_of(study, row.method, row.split), *EVEN)
    values = [s.score.value for s in even if s.score.status == "ok"]
    return fmean(values) if values else None


def to_ours(rows: list[Row], row: Row) -> float | None:
    """EMD (even) of `row` as a multiple of the paper's method's on the same parts, if it ran."""
    ours = [one.emd_even for one in rows if (one.method, one.split) == (paper.OURS, row.split)]
    return row.emd_even / ours[0] if ours else None


COLUMNS = (
    "method",
    "inputs",
    "split",
    "EMD (even)",
    "95 %",
    "EMD, mm",
    "floor",
    "x floor",
    "x industnerf",
    "EMD (iid)",
    "EMD (full)",
    "parts",
    "failed",
    "without failures",
    "s a part",
    "learned from",
    "paper",
)
HELD_OUT = {"family": "of other families", "part": "others", "none": "and itself"}


def cells(row: Row, extra: Extra) -> list[str]:
    """`row` as people read it, one text for each of COLUMNS."""
    return [
        row.method,
        row.inputs,
        row.split,
        short(row.emd_even),
        f"{row.ci_low:.4f} to {row.ci_high:.4f}",
        brief(row.emd_mm),
        short(row.floor),
        short(row.ratio_to_floor, 2),
        short(extra.to_ours, 2),
        short(row.emd_iid),
        short(row.emd_full),
        str(row.parts),
        str(row.failures),
        short(extra.emd_without_failures),
        short(extra.seconds, 2),
        lesson(row),
        _published(row.paper_emd),
    ]


def _published(emd: float | None) -> str:
    """The paper's EMD, and which multiple of its own method's that is: `0.0482 (3.96 x)`."""
    return "" if emd is None else f"{emd:.4f} ({emd / paper.EMD[paper.OURS]:.2f} x)"


def lesson(row: Row) -> str:
    """Such as `78 parts of other families, cpu: 1.2 M numbers, 4000 steps; undertrained: ...`."""
    if not row.learned_from:
        return ""
    parts = "part" if row.learned_from == 1 else "parts"
    text = f"{row.learned_from} {parts} {HELD_OUT[row.hold_out]}"
    if row.size:
        text += f"; {row.size}, {row.parameters / 1e6:.2g} M numbers, {row.steps} steps"
    return text + (f"; **undertrained**: {row.undertrained}" if row.undertrained else "")


def table1_md(rows: list[Row], extras: list[Extra], interval: float) -> str:
    """`table1.md`: Table 1 with the seconds of cost.csv."""
    lines = [cells(row, extra) for row, extra in zip(rows, extras, strict=True)]
    return markdown(intervals_of(COLUMNS, interval), lines)


SCORE_COLUMNS = (
    "part_id",
    "family",
    "method",
    "scope",
    "split",
    "preset",
    "seed",
    "metric",
    "protocol",
    "value",
    "floor",
    "unit",
    "status",
)


def scores_csv(study: Study) -> str:
    """`scores.csv`: every score with its family, split, preset and seed."""
    return csv_text(SCORE_COLUMNS, [_score_line(study, row) for row in study.scores])


def _score_line(study: Study, row: PartScore) -> list[object]:
    score = row.score
    return [
        row.part_id,
        study.parts[row.part_id].family,
        row.method,
        study.methods[row.method].scope.value,
        study.places[row.part_id].split,
        study.preset,
        study.seed,
        score.metric,
        score.protocol,
        f"{score.value:.9g}",
        f"{score.floor:.9g}",
        score.unit,
        score.status,
    ]
