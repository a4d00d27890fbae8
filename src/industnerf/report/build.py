"""Write the folder of a report.

table1.csv scores.csv      EMD of every method; every score
table2.csv table2.md       renderings and confidence
inspection.csv .md         errors of the clouds in millimeters
comparisons.csv .md        paired significance tests
strata.csv .md             methods by stratum of the parts
contact_sheet.png strata.png
sparsification.png         if a method returns candidates
summary.json               the means, for MLflow
metrics/ plots/            what `dvc metrics` and `dvc plots` show
cost.csv cost.md table1.md goals.csv goals.md pareto.png report.html metrics/ plots/pareto.csv
                           with timings, so they differ from run to run
origins.md                 machines and versions
"""

from pathlib import Path

from industnerf.artifacts.files import write_json, write_text
from industnerf.content import content_digest
from industnerf.report.figures.contact_sheet import draw_contact_sheet
from industnerf.report.figures.pareto import plot_pareto
from industnerf.report.figures.sparsification import plot_sparsification
from industnerf.report.figures.strata_heatmap import plot_strata
from industnerf.report.html.page import load_page_media, render_page
from industnerf.report.part_subsets import select_viewer_parts
from industnerf.report.publish.origins import origins_line, origins_md, read_origins
from industnerf.report.publish.provenance import provenance_line
from industnerf.report.results import Results
from industnerf.report.statistics.comparisons import comparisons_csv, comparisons_md
from industnerf.report.study import Study
from industnerf.report.tables.costs import cost_table_md, costs_csv, read_costs
from industnerf.report.tables.dvc_files import CURVES, curves_csv, dvc_file_texts
from industnerf.report.tables.goals import goals_csv, goals_md
from industnerf.report.tables.inspection import inspection_csv, inspection_md
from industnerf.report.tables.protocol_grid import load_published_grid
from industnerf.report.tables.scores import scores_csv
from industnerf.report.tables.strata import strata_csv, strata_md
from industnerf.report.tables.table1_format import table1_csv, table1_md
from industnerf.report.tables.table2 import metric_means, table2_csv, table2_md
from industnerf.schema import ReportParams


def build_report(study: Study, settings: ReportParams, grid_folder: Path, out: Path) -> None:
    """Write every file of the report into `out`.

    The page shows the grid of protocols in `grid_folder`, if there is one.
    """
    costs = read_costs(study.folders, list(study.methods))
    origins = read_origins(study.folders, list(study.methods))
    results = Results.from_study(study, settings, costs)
    write_text(out / "cost.csv", costs_csv(costs))
    write_text(out / "origins.md", origins_md(origins))
    write_tables(results, out)
    write_text(out / CURVES, curves_csv(study))
    viewer_parts = select_viewer_parts(study, settings.contact_sheet_parts)
    sheet_png = draw_contact_sheet(study, viewer_parts)
    figures = score_figures(results)
    sparsification_png = plot_sparsification(study)
    media = load_page_media(
        study, viewer_parts, sheet_png, figures["pareto.png"], sparsification_png
    )
    provenance = ". ".join(filter(None, (provenance_line(), origins_line(origins))))
    page = render_page(results, media, load_published_grid(grid_folder), provenance)
    write_text(out / "report.html", page)
    for name, png in figures.items():
        (out / name).write_bytes(png)
    if sheet_png:
        (out / "contact_sheet.png").write_bytes(sheet_png)
    if sparsification_png:
        (out / "sparsification.png").write_bytes(sparsification_png)
    write_json(out / "summary.json", _summary(results, out))


def score_figures(results: Results) -> dict[str, bytes]:
    """The figures that need no more than `results`, by the names of their files."""
    figures = {"pareto.png": plot_pareto(results)}
    if strata := plot_strata(results.strata):
        figures["strata.png"] = strata
    return figures


def write_tables(results: Results, out: Path) -> None:
    """Write every table into `out`, as CSV and as Markdown."""
    for name, text in table_texts(results).items():
        write_text(out / name, text)


def table_texts(results: Results) -> dict[str, str]:
    """The text of every table, by the name of its file."""
    interval = results.interval
    return {
        "table1.csv": table1_csv(results.table1),
        "table1.md": table1_md(results.table1, results.table1_extras, interval),
        "table2.csv": table2_csv(results.table2),
        "table2.md": table2_md(results.table2, interval),
        "inspection.csv": inspection_csv(results.inspection),
        "inspection.md": inspection_md(results.inspection),
        "comparisons.csv": comparisons_csv(results.comparisons),
        "comparisons.md": comparisons_md(results.comparisons, interval),
        "strata.csv": strata_csv(results.strata),
        "strata.md": strata_md(results.strata),
        "goals.csv": goals_csv(results.goals),
        "goals.md": goals_md(results.goals),
        "cost.md": cost_table_md(results.costs),
        "scores.csv": scores_csv(results.study),
        **dvc_file_texts(results),
    }


def _summary(results: Results, out: Path) -> dict:
    table1_means = {
        f"{row.method}.{row.split}.{name}": getattr(row, name)
        for row in results.table1
        for name in ("emd_even", "emd_iid", "emd_full", "floor", "ratio_to_floor", "failures")
    }
    return {
        "schema": 1,
        "results": content_digest([out / "table1.csv", out / "scores.csv"]),
        "preset": results.study.preset,
        "parts": len(results.study.parts),
        "metrics": table1_means | metric_means(results.table2),
    }
