"""On the page: what was to be reached, what is more than chance, which kinds of parts suit whom."""

from collections.abc import Iterable, Sequence
from html import escape

from industnerf.report.html.markup import Column, HtmlRow, emphasized, html_table, note
from industnerf.report.statistics import comparisons
from industnerf.report.tables import cost_table, goals, inspection
from industnerf.report.tables.formats import format_significant, label_intervals
from industnerf.report.tables.strata import ALL, StratumRow

TEXT_COLUMNS = ("method", "against", "parts")
COMPARISONS_NOTE = (
    "Mean difference of the EMD (even) over the test parts that both have; below 0 the first is "
    "better. p by flipping the signs of whole families, exact where there are few of them, and "
    "corrected after Holm: for all pairs of ours together, and for those of nets with what they "
    "must beat. <i>better on</i> is the share of the parts."
)
GOALS_NOTE = (
    "What the suite set out to reach on the test parts, written down before its methods were. A "
    "bound that was missed stays where it was. <i>beside it</i>: of lengths the mean in mm; of "
    "seconds, whose mean is what was to be reached, how many of the parts are above the bound all "
    "the same. Beside those about clouds stands the same number of <i>tsdf</i>, which is given "
    "true depth, and of <i>oracle</i>, a sample of the true surface: beyond the latter a goal is "
    "out of anyone's reach."
)
INSPECTION_NOTE = (
    "Over the test parts; the mean in mm is that of the large ones, so the median stands beside "
    "it. <i>cloud within</i> is the share of a cloud's points that are so near to the true "
    "surface, whatever of the surface they leave out; <i>Hausdorff-95</i> is the larger of the "
    "95th percentiles of the distances from the cloud to the surface and back."
)
COSTS_NOTE = (
    "One core each, while as many parts ran as there are cores; not the same from run to run. "
    "<i>beside it</i> are the renderings of the held-out views for Table 2. <i>numbers</i> are "
    "those that are learned, of one part or net."
)
STRATA_NOTE = (
    "Mean EMD (even) over the test parts of each kind, whose number stands beside the kind, and in "
    "mm."
)


def comparisons_html(rows: Sequence[comparisons.Comparison], interval: float) -> str:
    """A row for every pair of methods that is compared; empty if none is."""
    if not rows:
        return ""
    heads = label_intervals(comparisons.COLUMNS, interval)
    columns = [Column(head, head in TEXT_COLUMNS) for head in heads]
    return html_table(
        columns, [HtmlRow([*map(escape, comparisons.format_row(row))]) for row in rows]
    ) + note(COMPARISONS_NOTE)


def goals_html(rows: Sequence[goals.Goal]) -> str:
    """A row a goal; empty if the study has none of the methods."""
    if not rows:
        return ""
    numbers = ("measured", "beside it", *goals.REFERENCE_METHODS)
    columns = [Column(head, head not in numbers) for head in goals.COLUMNS]
    html_rows = [HtmlRow([*_goal_cells(goal)]) for goal in rows]
    return html_table(columns, html_rows) + note(GOALS_NOTE)


def _goal_cells(goal: goals.Goal) -> Iterable[str]:
    for head, cell in zip(goals.COLUMNS, goals.format_row(goal), strict=True):
        is_missed = head == "met" and not goal.is_met
        yield emphasized("no") if is_missed else escape(cell)


def inspection_html(rows: Sequence[inspection.InspectionRow]) -> str:
    """A row a method; empty if there is no test part."""
    if not rows:
        return ""
    columns = [Column(head, head == "method") for head in inspection.headers(rows)]
    html_rows = [HtmlRow([*map(escape, inspection.format_row(row))]) for row in rows]
    return html_table(columns, html_rows) + note(INSPECTION_NOTE)


def cost_table_html(rows: Sequence[cost_table.MethodCost]) -> str:
    """A row a method."""
    columns = [Column(head, head == "method") for head in cost_table.COLUMNS]
    return html_table(
        columns, [HtmlRow([*map(escape, cost_table.format_row(row))]) for row in rows]
    ) + note(COSTS_NOTE)


def strata_html(rows: Sequence[StratumRow]) -> str:
    """A row a method and a column a stratum; empty if there is no test part."""
    if not rows:
        return ""
    sizes = {row.stratum: row.parts for row in rows}
    means = {(row.method, row.stratum): row for row in rows}
    columns = [Column("method", True)]
    columns += [Column(f"{name} ({parts})") for name, parts in sizes.items()]
    html_rows = [
        HtmlRow([escape(row.method), *(_mean(means.get((row.method, name))) for name in sizes)])
        for row in rows
        if row.stratum == ALL
    ]
    return html_table(columns, html_rows) + note(STRATA_NOTE)


def _mean(row: StratumRow | None) -> str:
    if row is None:  # none of its parts could be scored
        return ""
    return f"{row.emd_even:.4f} <small>{format_significant(row.emd_mm)} mm</small>"
