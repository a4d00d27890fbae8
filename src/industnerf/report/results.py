"""All tables of a report, made once from a study and its costs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from industnerf.report.statistics.comparisons import Comparison, compare_methods
from industnerf.report.study import Study
from industnerf.report.tables.costs import (
    CostRow,
    MethodCost,
    Point,
    method_costs,
    seconds_and_ratios,
    seconds_per_part,
)
from industnerf.report.tables.goals import Goal, evaluate_goals
from industnerf.report.tables.inspection import InspectionRow, inspection_rows
from industnerf.report.tables.strata import StratumRow, stratum_rows
from industnerf.report.tables.table1 import (
    Table1Row,
    mean_without_failures,
    ratio_to_paper_method,
    table1_rows,
)
from industnerf.report.tables.table1_format import Table1Extra
from industnerf.report.tables.table2 import Table2Row, table2_rows
from industnerf.schema import ReportParams


@dataclass(frozen=True)
class Results:
    """The tables of one study; `interval` is the confidence level of their intervals."""

    study: Study
    interval: float
    table1: Sequence[Table1Row]
    table1_extras: Sequence[Table1Extra]  # one for each row
    table2: Sequence[Table2Row]
    comparisons: Sequence[Comparison]
    strata: Sequence[StratumRow]
    inspection: Sequence[InspectionRow]
    goals: Sequence[Goal]
    costs: Sequence[MethodCost]
    part_points: Mapping[str, Sequence[Point]]  # of the parts in the first row's split, by method

    @staticmethod
    def from_study(
        study: Study, settings: ReportParams, costs: Sequence[CostRow] = ()
    ) -> "Results":
        """All tables; seconds are None for methods that `costs` lack."""
        rows = table1_rows(study, settings)
        return Results(
            study,
            settings.confidence_level,
            rows,
            [
                Table1Extra(
                    mean_without_failures(study, row),
                    seconds_per_part(costs, row.method, _part_ids(study, row.split)),
                    ratio_to_paper_method(rows, row),
                    study.methods[row.method].role,
                    any(cost_row.cost.cpu_seconds is None for cost_row in costs),
                )
                for row in rows
            ],
            table2_rows(study, settings),
            compare_methods(study, settings),
            stratum_rows(study, settings),
            inspection_rows(study),
            evaluate_goals(study, costs),
            method_costs(study, costs),
            seconds_and_ratios(study, costs, rows[0].split) if rows else {},
        )


def _part_ids(study: Study, split: str) -> set[str]:
    return {name for name, assignment in study.assignments.items() if assignment.split == split}
