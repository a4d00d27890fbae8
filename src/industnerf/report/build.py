"""Write the report's folder.

table1.csv scores.csv      results
table2.csv table2.md       renderings and confidence, of methods that return them
comparisons.csv .md        what is better than what, beyond chance
strata.csv .md             which kinds of parts suit which method
contact_sheet.png report.html
summary.json               the means, for `dvc metrics` and MLflow
cost.csv table1.md pareto.png   with timings, so they differ from run to run
"""

from pathlib import Path

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from industnerf.artifacts.files import write_json, write_text
from industnerf.report.comparisons import comparisons, comparisons_csv, comparisons_md
from industnerf.report.costs import costs_csv, read_costs, seconds_per_part
from industnerf.report.exhibits import exhibits
from industnerf.report.gather import Study
from industnerf.report.grid import grid_html
from industnerf.report.page import page
from industnerf.report.pareto import pareto
from industnerf.report.sheet import contact_sheet
from industnerf.report.strata import strata, strata_csv, strata_md
from industnerf.report.subsets import exhibited
from industnerf.report.table2 import Line, means, table2, table2_csv, table2_md
from industnerf.report.tables import (
    COLUMNS,
    Extra,
    Row,
    cells,
    scores_csv,
    table1,
    table1_csv,
    table1_md,
    without_failures,
)
from industnerf.schema import ReportParams
from industnerf.store import content_digest

# What fits into 80 characters; the files have the rest.
ON_SCREEN = ("method", "EMD (even)", "95 %", "floor", "x floor", "failed", "s a part")


def build_report(study: Study, settings: ReportParams, grid: Path, out: Path) -> None:
    """Write every file of the report into `out`, and print Table 1.

    `grid` is the folder of a grid of protocols, which the page shows if it is there.
    """
    costs = read_costs(study.folders, list(study.methods))
    rows, lines = table1(study, settings), table2(study, settings)
    extras = [
        Extra(without_failures(study, row), seconds_per_part(costs, row.method)) for row in rows
    ]
    untimed = [Extra(extra.emd_without_failures, None) for extra in extras]
    chosen = exhibited(study, settings.sheet_parts)
    sheet = contact_sheet(study, chosen)
    shown = exhibits(study, chosen, sheet)
    write_text(out / "table1.csv", table1_csv(rows))
    write_text(out / "table1.md", table1_md(rows, extras, settings.interval))
    write_text(out / "table2.csv", table2_csv(lines))
    write_text(out / "table2.md", table2_md(lines, settings.interval))
    compared, kinds = comparisons(study, settings), strata(study, settings)
    write_text(out / "comparisons.csv", comparisons_csv(compared))
    write_text(out / "comparisons.md", comparisons_md(compared, settings.interval))
    write_text(out / "strata.csv", strata_csv(kinds))
    write_text(out / "strata.md", strata_md(kinds))
    write_text(out / "scores.csv", scores_csv(study))
    write_text(out / "cost.csv", costs_csv(costs))
    shown_page = page(
        study, rows, untimed, lines, shown, settings.interval, compared, kinds, grid_html(grid)
    )
    write_text(out / "report.html", shown_page)
    (out / "pareto.png").write_bytes(pareto(rows, extras))
    (out / "contact_sheet.png").write_bytes(sheet)
    write_json(out / "summary.json", _summary(study, rows, lines, out))
    _show(rows, extras, out)


def _summary(study: Study, rows: list[Row], lines: list[Line], out: Path) -> dict:
    table1_means = {
        f"{row.method}.{row.split}.{name}": getattr(row, name)
        for row in rows
        for name in ("emd_even", "emd_iid", "emd_full", "floor", "ratio_to_floor", "failures")
    }
    return {
        "schema": 1,
        "inputs": content_digest([out / "table1.csv", out / "scores.csv"]),
        "preset": study.preset,
        "parts": len(study.parts),
        "metrics": table1_means | means(lines),
    }


def _show(rows: list[Row], extras: list[Extra], out: Path) -> None:
    shown = Table(
        title="Table 1: EMD in bounding-box diagonals; lower is better", box=SIMPLE, padding=(0, 0)
    )
    wanted = [COLUMNS.index(name) for name in ON_SCREEN]
    for i in wanted:
        shown.add_column(COLUMNS[i], justify="left" if i == 0 else "right", no_wrap=True)
    for row, extra in zip(rows, extras, strict=True):
        texts = cells(row, extra)
        if row.split != rows[0].split:
            continue  # the dev parts stand in the files
        shown.add_row(*[texts[i] for i in wanted])
    console = Console()
    console.print(shown)
    console.print(f"open {(out / 'report.html').absolute()}", markup=False, soft_wrap=True)
