"""Every method by stratum of the test parts: thin ones, ones with pockets, and so on.

Strata are formulas on the mesh (docs/reference/dataset.md). A part may be in several, or in none.
"""

from collections.abc import Sequence
from dataclasses import astuple, dataclass, fields
from statistics import fmean

from industnerf.report.statistics.comparisons import emd_even_by_part
from industnerf.report.statistics.significance import bootstrap_interval
from industnerf.report.study import Study
from industnerf.report.tables.formats import csv_text, format_significant, markdown_table
from industnerf.schema import ReportParams

ALL = "all"


@dataclass(frozen=True)
class StratumRow:
    """One method over the test parts of one stratum."""

    stratum: str
    method: str
    emd_even: float
    ci_low: float | None  # None: one family has no interval
    ci_high: float | None
    emd_mm: float  # mean of the parts in mm
    floor: float
    ratio_to_floor: float
    parts: int
    families: int
    failures: int


def stratum_rows(study: Study, settings: ReportParams) -> list[StratumRow]:
    """`all` first, then the strata by name; within one, the best method first."""
    names = {name for part in study.parts.values() for name in part.strata}
    rows = [
        row
        for stratum in (ALL, *sorted(names))
        for method in study.methods
        if (row := _row(study, settings, stratum, method))
    ]
    order = {row.stratum: index for index, row in enumerate(rows)}
    return sorted(rows, key=lambda row: (order[row.stratum], row.emd_even))


def _row(study: Study, settings: ReportParams, stratum: str, method: str) -> StratumRow | None:
    scores = {
        part: score
        for part, score in emd_even_by_part(study, method).items()
        if stratum in (ALL, *study.parts[part].strata)
    }
    if not scores:
        return None
    values = [score.value for score in scores.values()]
    families = [study.parts[part].family for part in scores]
    mean, floor = fmean(values), fmean(score.floor for score in scores.values())
    return StratumRow(
        stratum,
        method,
        mean,
        *bootstrap_interval(values, families, settings, study.seed),
        fmean(score.value * study.parts[part].diagonal_mm for part, score in scores.items()),
        floor,
        mean / floor,
        len(values),
        len(set(families)),
        sum(score.status != "ok" for score in scores.values()),
    )


def strata_csv(rows: Sequence[StratumRow]) -> str:
    """`strata.csv`, a column per field of StratumRow."""
    return csv_text([field.name for field in fields(StratumRow)], map(astuple, rows))


def strata_md(rows: Sequence[StratumRow]) -> str:
    """`strata.md`: a row per method, in the order of `all`, and a column per stratum."""
    by_cell = {(row.method, row.stratum): row for row in rows}
    sizes = {row.stratum: row.parts for row in rows}
    methods = [row.method for row in rows if row.stratum == ALL]
    table_rows = [
        [name, *(_cell(by_cell.get((name, stratum))) for stratum in sizes)] for name in methods
    ]
    return markdown_table(
        ["EMD (even)", *(f"{name} ({parts})" for name, parts in sizes.items())], table_rows
    )


def _cell(row: StratumRow | None) -> str:
    if row is None:  # none of its parts could be scored
        return ""
    return (
        f"{row.emd_even:.4f}, {format_significant(row.emd_mm)} mm, {row.ratio_to_floor:.2f} x floor"
    )
