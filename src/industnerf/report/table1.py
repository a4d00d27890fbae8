"""Table 1: the paper's, with floors and intervals."""

from dataclasses import dataclass, replace
from statistics import fmean

from industnerf.artifacts.scores import PartScore
from industnerf.methods.base import Method, Role
from industnerf.report import paper
from industnerf.report.gather import Lesson, Study
from industnerf.report.lookup import EVEN, only, scores_of
from industnerf.report.millimetres import in_mm
from industnerf.report.statistics import bootstrap_interval
from industnerf.schema import ReportParams

MUST_BEAT = ("retrieval", "mean_shape")  # by a net that deserves its name
STILL = "still learning"


@dataclass(frozen=True)
class Row:
    """One method over the parts of one split."""

    method: str
    scope: str
    inputs: str
    split: str
    preset: str
    views: int  # that an answer is made of
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
    answers: int  # whose mean the score is; but EMD (iid) and (full) are of the first with points
    seeds_sd: float | None  # of the mean EMD (even) of some test parts, over seeds; where known
    empty_answers: int | None  # over the parts that did not fail; each scores as a failure
    families: int  # of the parts; of one there is no interval: lowest and highest part instead


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
    why = [] if study.lessons[row.method].settled else [STILL]
    why += [
        f"no better than {other.method}"
        for other in rows
        if other.method in MUST_BEAT and other.split == row.split and other.emd_even <= row.emd_even
    ]
    return ", ".join(why)


def _row(
    study: Study, settings: ReportParams, method: Method, split: str, scores: list[PartScore]
) -> Row:
    even = only(scores, *EVEN)
    values = [row.score.value for row in even]
    families = [study.parts[row.part_id].family for row in even]
    low, high = bootstrap_interval(values, families, settings, study.seed)
    floor = fmean(row.score.floor for row in even)
    parameters, steps = study.training[method.name]
    size, learned_from, hold_out = _learned(study.lessons.get(method.name))
    return Row(
        method=method.name,
        scope=method.scope.value,
        inputs=inputs_of(method),
        split=split,
        preset=study.preset,
        views=study.given[method.name].each,
        emd_even=fmean(values),
        ci_low=low,
        ci_high=high,
        floor=floor,
        ratio_to_floor=fmean(values) / floor,
        emd_iid=_mean(scores, "P1-iid"),
        emd_full=_mean(scores, "P1-full"),
        parts=len(even),
        failures=sum(row.score.status != "ok" for row in even),
        parameters=parameters,
        steps=steps,
        paper_emd=paper.EMD.get(method.name),
        size=size,
        learned_from=learned_from,
        hold_out=hold_out,
        undertrained="",
        emd_mm=fmean(in_mm(study, even)),
        answers=study.given[method.name].answers,
        empty_answers=study.empty_answers.get((method.name, split)),
        families=len(set(families)),
        seeds_sd=study.seeds_sd.get(method.name) if split == "test" else None,
    )


def _learned(lesson: Lesson | None) -> tuple[str, int, str]:
    return ("", 0, "") if lesson is None else (lesson.size, lesson.parts, lesson.hold_out)


def inputs_of(method: Method) -> str:
    """Declared inputs; a null or a bound says so, for its row is no competitor's."""
    names = " + ".join(sorted(method.inputs))
    return names if method.role == Role.METHOD else f"{names} ({method.role.value})"


def _mean(scores: list[PartScore], protocol: str) -> float:
    return fmean(row.score.value for row in only(scores, "emd", protocol))


def without_failures(study: Study, row: Row) -> float | None:
    """Mean EMD (even) over the parts that did not fail."""
    even = only(scores_of(study, row.method, row.split), *EVEN)
    values = [s.score.value for s in even if s.score.status == "ok"]
    return fmean(values) if values else None


def to_ours(rows: list[Row], row: Row) -> float | None:
    """EMD (even) of `row` as a multiple of the paper's method's on the same parts, if it ran."""
    ours = [one.emd_even for one in rows if (one.method, one.split) == (paper.METHOD, row.split)]
    return row.emd_even / ours[0] if ours else None
