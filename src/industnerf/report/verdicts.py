"""On the page: what was to be reached, what is more than chance, which kinds of parts suit whom."""

from collections.abc import Iterable, Sequence
from html import escape

from industnerf.report import comparisons, goals, inspection, spending
from industnerf.report.formats import brief, intervals_of
from industnerf.report.markup import Column, Line, note, table, warning
from industnerf.report.strata import ALL, Stratum

WORDS = ("method", "against", "parts")
COMPARED = (
    "Mean difference of the EMD (even) over the test parts that both have; below 0 the first is "
    "better. p by flipping the signs of whole families, exact where there are few of them, and "
    "corrected after Holm: for all pairs of ours together, and for those of nets with what they "
    "must beat. <i>better on</i> is the share of the parts."
)
GOALS = (
    "What the suite set out to reach on the test parts, written down before its methods were. A "
    "bound that was missed stays where it was. <i>beside it</i>: of lengths the mean in mm; of "
    "seconds, whose mean is what was to be reached, how many of the parts are above the bound all "
    "the same. Beside those about clouds stands the same number of <i>tsdf</i>, which is given "
    "true depth, and of <i>oracle</i>, a sample of the true surface: beyond the latter a goal is "
    "out of anyone's reach."
)
INSPECTED = (
    "Over the test parts; the mean in mm is that of the large ones, so the median stands beside "
    "it. <i>cloud within</i> is the share of a cloud's points that are so near to the true "
    "surface, whatever of the surface they leave out; <i>Hausdorff-95</i> is the larger of the "
    "95th percentiles of the distances from the cloud to the surface and back."
)
SPENT = (
    "One core each, while as many parts ran as there are cores; not the same from run to run. "
    "<i>beside it</i> are the renderings of the held-out views for Table 2. <i>numbers</i> are "
    "those that are learned, of one part or net."
)
KINDS = (
    "Mean EMD (even) over the test parts of each kind, whose number stands beside the kind, and in "
    "mm."
)


def comparisons_html(found: Sequence[comparisons.Comparison], interval: float) -> str:
    """A row for every pair of methods that is compared; empty if none is."""
    if not found:
        return ""
    heads = intervals_of(comparisons.COLUMNS, interval)
    columns = [Column(head, head in WORDS) for head in heads]
    return table(columns, [Line([*map(escape, comparisons.cells(each))]) for each in found]) + note(
        COMPARED
    )


def goals_html(found: Sequence[goals.Goal]) -> str:
    """A row a goal; empty if the study has none of the methods."""
    if not found:
        return ""
    numbers = ("measured", "beside it", *goals.YARDSTICKS)
    columns = [Column(head, head not in numbers) for head in goals.COLUMNS]
    lines = [Line([*_goal_cells(goal)]) for goal in found]
    return table(columns, lines) + note(GOALS)


def _goal_cells(goal: goals.Goal) -> Iterable[str]:
    for head, cell in zip(goals.COLUMNS, goals.cells(goal), strict=True):
        missed = head == "met" and not goal.met
        yield warning("no") if missed else escape(cell)


def inspection_html(lines: Sequence[inspection.Inspected]) -> str:
    """A row a method; empty if there is no test part."""
    if not lines:
        return ""
    columns = [Column(head, head == "method") for head in inspection.columns(lines)]
    shown = [Line([*map(escape, inspection.cells(line))]) for line in lines]
    return table(columns, shown) + note(INSPECTED)


def spending_html(lines: Sequence[spending.Spending]) -> str:
    """A row a method."""
    columns = [Column(head, head == "method") for head in spending.COLUMNS]
    return table(columns, [Line([*map(escape, spending.cells(line))]) for line in lines]) + note(
        SPENT
    )


def strata_html(rows: Sequence[Stratum]) -> str:
    """A row a method and a column a stratum; empty if there is no test part."""
    if not rows:
        return ""
    sizes = {row.stratum: row.parts for row in rows}
    means = {(row.method, row.stratum): row for row in rows}
    columns = [Column("method", True)]
    columns += [Column(f"{name} ({parts})") for name, parts in sizes.items()]
    lines = [
        Line([escape(row.method), *(_mean(means.get((row.method, name))) for name in sizes)])
        for row in rows
        if row.stratum == ALL
    ]
    return table(columns, lines) + note(KINDS)


def _mean(row: Stratum | None) -> str:
    if row is None:  # none of its parts could be scored
        return ""
    return f"{row.emd_even:.4f} <small>{brief(row.emd_mm)} mm</small>"
