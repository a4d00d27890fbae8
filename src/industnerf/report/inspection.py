"""Every method in millimetres, the language of inspection.

Parts are of very different sizes: a mean in mm is that of the large ones, so medians stand beside.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean, median

from industnerf.artifacts.scores import PartScore
from industnerf.report.formats import brief, csv_text, markdown
from industnerf.report.gather import Study
from industnerf.report.lookup import EVEN, only, scores_of
from industnerf.report.millimetres import in_mm

WITHIN, COVERED = "within_", "covered_"  # names of metrics begin so, and end with a tolerance


@dataclass(frozen=True)
class Inspected:
    """One method over the test parts, failures included; None of what was not measured."""

    method: str
    emd_mm: float
    emd_median_mm: float
    hausdorff95_mm: float | None
    hausdorff95_median_mm: float | None
    within: dict[str, float | None]  # tolerance -> share of the cloud's points
    covered: dict[str, float | None]  # tolerance -> share of the visible surface
    parts: int


def inspection(study: Study) -> list[Inspected]:
    """A line a method, the smallest median EMD first."""
    metrics = list(dict.fromkeys(row.score.metric for row in study.scores))
    lines = [
        _line(study, method, scores, metrics)
        for method in study.methods
        if (scores := scores_of(study, method, "test"))
    ]
    return sorted(lines, key=lambda line: line.emd_median_mm)


def _line(study: Study, method: str, scores: list[PartScore], metrics: list[str]) -> Inspected:
    even = only(scores, *EVEN)
    emds = in_mm(study, even)
    worst = _values(scores, "hausdorff95")
    return Inspected(
        method,
        fmean(emds),
        median(emds),
        fmean(worst) if worst else None,
        median(worst) if worst else None,
        _shares(scores, metrics, WITHIN),
        _shares(scores, metrics, COVERED),
        len(emds),
    )


def _shares(scores: list[PartScore], metrics: list[str], kind: str) -> dict[str, float | None]:
    """By tolerance, the mean of the metrics whose names begin with `kind`."""
    known = {
        metric.removeprefix(kind): _values(scores, metric)
        for metric in metrics
        if metric.startswith(kind)
    }
    return {limit: fmean(values) if values else None for limit, values in known.items()}


def _values(scores: list[PartScore], metric: str) -> list[float]:
    return [row.score.value for row in only(scores, metric, "P1-dense")]


def inspection_csv(lines: Sequence[Inspected]) -> str:
    """`inspection.csv`, one column a field of Inspected, and one a tolerance."""
    plain = ("method", "emd_mm", "emd_median_mm", "hausdorff95_mm", "hausdorff95_median_mm")
    return csv_text(
        [*plain, *_of_limits(lines, WITHIN + "{}", COVERED + "{}"), "parts"],
        [[*(getattr(line, name) for name in plain), *_of(line), line.parts] for line in lines],
    )


def _of_limits(lines: Sequence[Inspected], within: str, covered: str) -> list[str]:
    """One text a share of `_of`, made of its tolerance."""
    if not lines:
        return []
    first = lines[0]
    return [*map(within.format, first.within), *map(covered.format, first.covered)]


def _of(line: Inspected) -> list[float | None]:
    return [*line.within.values(), *line.covered.values()]


def columns(lines: Sequence[Inspected]) -> list[str]:
    """Heads of what `cells` gives."""
    shares = _of_limits(lines, "cloud within {}", "surface within {}")
    return [
        "method",
        "EMD, mm",
        "EMD, median",
        "Hausdorff-95, mm",
        "Hausdorff-95, median",
        *(share.replace("mm", " mm") for share in shares),
        "parts",
    ]


def cells(line: Inspected) -> list[str]:
    """`line` as people read it, one text for each of `columns`."""
    return [
        line.method,
        brief(line.emd_mm),
        brief(line.emd_median_mm),
        brief(line.hausdorff95_mm),
        brief(line.hausdorff95_median_mm),
        *("" if share is None else f"{100 * share:.1f} %" for share in _of(line)),
        str(line.parts),
    ]


def inspection_md(lines: Sequence[Inspected]) -> str:
    """`inspection.md`."""
    return markdown(columns(lines), map(cells, lines))
