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

WITHIN = "within_"


@dataclass(frozen=True)
class Inspected:
    """One method over the test parts, failures included; None of what was not measured."""

    method: str
    emd_mm: float
    emd_median_mm: float
    hausdorff95_mm: float | None
    hausdorff95_median_mm: float | None
    within: dict[str, float | None]  # tolerance -> share of the cloud's points, not of the surface
    parts: int


def inspection(study: Study) -> list[Inspected]:
    """A line a method, the smallest median EMD first."""
    metrics = dict.fromkeys(row.score.metric for row in study.scores)
    within = [metric for metric in metrics if metric.startswith(WITHIN)]
    lines = [
        _line(study, method, scores, within)
        for method in study.methods
        if (scores := scores_of(study, method, "test"))
    ]
    return sorted(lines, key=lambda line: line.emd_median_mm)


def _line(study: Study, method: str, scores: list[PartScore], within: list[str]) -> Inspected:
    even = only(scores, *EVEN)
    emds = [row.score.value * study.parts[row.part_id].diagonal_mm for row in even]
    worst = _values(scores, "hausdorff95")
    shares = {metric.removeprefix(WITHIN): _values(scores, metric) for metric in within}
    return Inspected(
        method,
        fmean(emds),
        median(emds),
        fmean(worst) if worst else None,
        median(worst) if worst else None,
        {limit: fmean(values) if values else None for limit, values in shares.items()},
        len(emds),
    )


def _values(scores: list[PartScore], metric: str) -> list[float]:
    return [row.score.value for row in only(scores, metric, "P1-dense")]


def inspection_csv(lines: Sequence[Inspected]) -> str:
    """`inspection.csv`, one column a field of Inspected, and one a tolerance."""
    plain = ("method", "emd_mm", "emd_median_mm", "hausdorff95_mm", "hausdorff95_median_mm")
    limits = lines[0].within if lines else {}
    return csv_text(
        [*plain, *(WITHIN + limit for limit in limits), "parts"],
        [
            [*(getattr(line, name) for name in plain), *line.within.values(), line.parts]
            for line in lines
        ],
    )


def columns(lines: Sequence[Inspected]) -> list[str]:
    """Heads of what `cells` gives."""
    limits = lines[0].within if lines else {}
    return [
        "method",
        "EMD, mm",
        "EMD, median",
        "Hausdorff-95, mm",
        "Hausdorff-95, median",
        *(f"cloud within {limit.replace('mm', ' mm')}" for limit in limits),
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
        *("" if share is None else f"{100 * share:.1f} %" for share in line.within.values()),
        str(line.parts),
    ]


def inspection_md(lines: Sequence[Inspected]) -> str:
    """`inspection.md`."""
    return markdown(columns(lines), map(cells, lines))
