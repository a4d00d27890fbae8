"""Write the report's folder.

table1.csv scores.csv      results
table2.csv table2.md       renderings and confidence, of methods that return them
inspection.csv .md         the same clouds in millimetres
comparisons.csv .md        what is better than what, beyond chance
strata.csv .md             which kinds of parts suit which method
contact_sheet.png
sparsification.png         if a method returns candidates
summary.json               the means, for MLflow
cost.csv cost.md table1.md goals.csv goals.md pareto.png report.html
                           with timings, so they differ from run to run
"""

from pathlib import Path

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from industnerf.artifacts.files import write_json, write_text
from industnerf.report.comparisons import comparisons_csv, comparisons_md
from industnerf.report.costs import costs_csv, read_costs
from industnerf.report.every_score import scores_csv
from industnerf.report.exhibits import exhibits
from industnerf.report.formats import intervals_of
from industnerf.report.gather import Study
from industnerf.report.goals import goals_csv, goals_md
from industnerf.report.grid import grid_html
from industnerf.report.inspection import inspection_csv, inspection_md
from industnerf.report.page import page
from industnerf.report.pareto import pareto
from industnerf.report.provenance import stamp
from industnerf.report.results import Results
from industnerf.report.sheet import contact_sheet
from industnerf.report.sparsification import sparsification
from industnerf.report.spending import spending_md
from industnerf.report.strata import strata_csv, strata_md
from industnerf.report.subsets import exhibited
from industnerf.report.table1_text import COLUMNS, cells, table1_csv, table1_md
from industnerf.report.table2 import means, table2_csv, table2_md
from industnerf.schema import ReportParams
from industnerf.store import content_digest

# What fits into 80 characters; the files have the rest.
ON_SCREEN = ("method", "EMD (even)", "95 %", "floor", "x floor", "failed", "s a part")


def build_report(study: Study, settings: ReportParams, grid: Path, out: Path) -> None:
    """Write every file of the report into `out`, and print Table 1.

    `grid` is the folder of a grid of protocols, which the page shows if it is there.
    """
    costs = read_costs(study.folders, list(study.methods))
    results = Results.of(study, settings, costs)
    write_text(out / "cost.csv", costs_csv(costs))
    write_tables(results, out)
    chosen = exhibited(study, settings.sheet_parts)
    sheet, front = contact_sheet(study, chosen), pareto(results.rows, results.extras)
    curves = sparsification(study)
    shown = exhibits(study, chosen, sheet, front, curves)
    write_text(out / "report.html", page(results, shown, grid_html(grid), stamp()))
    (out / "pareto.png").write_bytes(front)
    if sheet:
        (out / "contact_sheet.png").write_bytes(sheet)
    if curves:
        (out / "sparsification.png").write_bytes(curves)
    write_json(out / "summary.json", _summary(results, out))
    _show(results, out)


def write_tables(results: Results, out: Path) -> None:
    """Every table, as CSV and as Markdown."""
    for name, text in table_texts(results).items():
        write_text(out / name, text)


def table_texts(results: Results) -> dict[str, str]:
    """The text of every table, by the name of its file."""
    interval = results.interval
    return {
        "table1.csv": table1_csv(results.rows),
        "table1.md": table1_md(results.rows, results.extras, interval),
        "table2.csv": table2_csv(results.lines),
        "table2.md": table2_md(results.lines, interval),
        "inspection.csv": inspection_csv(results.inspected),
        "inspection.md": inspection_md(results.inspected),
        "comparisons.csv": comparisons_csv(results.compared),
        "comparisons.md": comparisons_md(results.compared, interval),
        "strata.csv": strata_csv(results.kinds),
        "strata.md": strata_md(results.kinds),
        "goals.csv": goals_csv(results.reached),
        "goals.md": goals_md(results.reached),
        "cost.md": spending_md(results.spent),
        "scores.csv": scores_csv(results.study),
    }


def _summary(results: Results, out: Path) -> dict:
    table1_means = {
        f"{row.method}.{row.split}.{name}": getattr(row, name)
        for row in results.rows
        for name in ("emd_even", "emd_iid", "emd_full", "floor", "ratio_to_floor", "failures")
    }
    return {
        "schema": 1,
        "results": content_digest([out / "table1.csv", out / "scores.csv"]),
        "preset": results.study.preset,
        "parts": len(results.study.parts),
        "metrics": table1_means | means(results.lines),
    }


def _show(results: Results, out: Path) -> None:
    shown = Table(
        title="Table 1: EMD in bounding-box diagonals; lower is better", box=SIMPLE, padding=(0, 0)
    )
    wanted = [COLUMNS.index(name) for name in ON_SCREEN]
    heads = intervals_of(COLUMNS, results.interval)
    for i in wanted:
        shown.add_column(heads[i], justify="left" if i == 0 else "right", no_wrap=True)
    for row, extra in zip(results.rows, results.extras, strict=True):
        texts = cells(row, extra)
        if row.split != results.rows[0].split:
            continue  # the dev parts stand in the files
        shown.add_row(*[texts[i] for i in wanted])
    console = Console()
    console.print(shown)
    console.print(f"open {(out / 'report.html').absolute()}", markup=False, soft_wrap=True)
