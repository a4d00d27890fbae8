"""Every table of a report, made once from a study and what it cost."""

from collections.abc import Sequence
from dataclasses import dataclass

from industnerf.report.comparisons import Comparison, comparisons
from industnerf.report.costs import CostRow, seconds_per_part
from industnerf.report.gather import Study
from industnerf.report.goals import Goal, goals
from industnerf.report.inspection import Inspected, inspection
from industnerf.report.spending import Spending, spending
from industnerf.report.strata import Stratum, strata
from industnerf.report.table1 import Row, table1, to_ours, without_failures
from industnerf.report.table1_text import Extra
from industnerf.report.table2 import Line, table2
from industnerf.schema import ReportParams


@dataclass(frozen=True)
class Results:
    """The tables of one study; `interval` is what their intervals cover, such as 0.95."""

    study: Study
    interval: float
    rows: Sequence[Row]  # of Table 1
    extras: Sequence[Extra]  # one a row
    lines: Sequence[Line]  # of Table 2
    compared: Sequence[Comparison]
    kinds: Sequence[Stratum]
    inspected: Sequence[Inspected]
    reached: Sequence[Goal]
    spent: Sequence[Spending]

    @staticmethod
    def of(study: Study, settings: ReportParams, costs: Sequence[CostRow] = ()) -> "Results":
        """Everything; where `costs` lack a method, so do the seconds."""
        rows = table1(study, settings)
        return Results(
            study,
            settings.interval,
            rows,
            [
                Extra(
                    without_failures(study, row),
                    seconds_per_part(costs, row.method, _parts(study, row.split)),
                    to_ours(rows, row),
                    study.methods[row.method].role,
                )
                for row in rows
            ],
            table2(study, settings),
            comparisons(study, settings),
            strata(study, settings),
            inspection(study),
            goals(study, costs),
            spending(study, costs),
        )


def _parts(study: Study, split: str) -> set[str]:
    return {name for name, place in study.places.items() if place.split == split}
