"""On the page: which differences are more than chance, and which kinds of parts suit whom."""

from collections.abc import Sequence
from html import escape

from industnerf.report import comparisons
from industnerf.report.formats import intervals_of
from industnerf.report.markup import Column, Line, note, table
from industnerf.report.strata import ALL, Stratum

WORDS = ("method", "against", "parts")
COMPARED = (
    "Mean difference of the EMD (even) over the test parts that both have; below 0 the first is "
    "better. p by flipping the signs of whole families, exact where there are few of them, and "
    "corrected for all pairs of this table after Holm. <i>better on</i> is the share of the parts."
)
KINDS = "Mean EMD (even) over the test parts of each kind, whose number stands beside the kind."


def comparisons_html(found: Sequence[comparisons.Comparison], interval: float) -> str:
    """A row for every pair of methods that is compared; empty if none is."""
    if not found:
        return ""
    heads = intervals_of(comparisons.COLUMNS, interval)
    columns = [Column(head, head in WORDS) for head in heads]
    return table(columns, [Line([*map(escape, comparisons.cells(each))]) for each in found]) + note(
        COMPARED
    )


def strata_html(rows: Sequence[Stratum]) -> str:
    """A row a method and a column a stratum; empty if there is no test part."""
    if not rows:
        return ""
    sizes = {row.stratum: row.parts for row in rows}
    means = {(row.method, row.stratum): row.emd_even for row in rows}
    columns = [Column("method", True)]
    columns += [Column(f"{name} ({parts})") for name, parts in sizes.items()]
    lines = [
        Line([escape(row.method), *(f"{means[row.method, name]:.4f}" for name in sizes)])
        for row in rows
        if row.stratum == ALL
    ]
    return table(columns, lines) + note(KINDS)
