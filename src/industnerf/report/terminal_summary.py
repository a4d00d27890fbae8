"""What a finished run prints: Table 1 in short, what it shows, and where the page is."""

from collections import defaultdict
from pathlib import Path
from statistics import fmean

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from industnerf.report import paper_results
from industnerf.report.tables.costs import csv_seconds
from industnerf.report.tables.formats import read_csv

SUMMARY = "INDUSTNERF_SUMMARY"  # `off`: `pipeline.preset` prints it, after every run
TEXT_COLUMNS = 2  # the others are numbers
HEADS = ("method", "inputs", "EMD", "x floor", "failed", "s a part", "paper")


def print_summary(report: Path, shown_as: Path) -> None:
    """Print Table 1 of the report in the folder `report`, which is `shown_as` for the reader."""
    rows, seconds = read_csv(report / "table1.csv"), mean_seconds(report)
    rows = [row for row in rows if row["split"] == rows[0]["split"]]  # dev parts: in the files
    has_failures = any(row["failures"] != "0" for row in rows)
    shown = [i for i, head in enumerate(HEADS) if head != "failed" or has_failures]
    table = Table(box=SIMPLE, padding=(0, 1, 0, 0))
    for i in shown:
        justify = "left" if i < TEXT_COLUMNS else "right"
        table.add_column(HEADS[i], justify=justify, no_wrap=HEADS[i] != "inputs")
    for row in rows:
        cells = _cells(row, seconds.get(row["method"]))
        table.add_row(*(cells[i] for i in shown))
    console = Console()
    console.print(table)
    console.print(conclusion(rows), markup=False, highlight=False)
    console.print(f"open {shown_as / 'report.html'}", markup=False, soft_wrap=True)


def _cells(row: dict[str, str], seconds: float | None) -> list[str]:
    method = row["method"] + ("\n(undertrained)" if row["undertrained"] else "")
    return [
        method,
        row["inputs"],
        f"{float(row['emd_even']):.4f}",
        f"{float(row['ratio_to_floor']):.2f}",
        row["failures"],
        "" if seconds is None else f"{seconds:.1f}",
        f"{float(row['paper_emd']):.4f}" if row["paper_emd"] else "",
    ]


def mean_seconds(report: Path) -> dict[str, float]:
    """The mean processor seconds of a reconstruction, by method."""
    seconds = defaultdict[str, list[float]](list)
    for row in read_csv(report / "cost.csv"):
        if row["stage"] == "reconstruct":
            seconds[row["method"]].append(csv_seconds(row))
    return {method: fmean(values) for method, values in seconds.items()}


def conclusion(rows: list[dict[str, str]]) -> str:
    """What the rows of one split say: the best method, and the paper's."""
    parts = f"{rows[0]['parts']} part" + ("s" if rows[0]["parts"] != "1" else "")
    unit = "the EMD of a perfect reconstruction (x floor)"
    methods = [row for row in rows if not row["inputs"].endswith(")")]  # no null, no bound
    if not methods:
        return f"x floor: EMD over that of a perfect reconstruction, the mean of {parts}."
    best, ratio = methods[0]["method"], float(methods[0]["ratio_to_floor"])
    text = f"On {parts} {best} comes closest to the true surface: {ratio:.2f} times {unit}"
    paper = [row for row in methods if row["method"] == paper_results.METHOD]
    if paper and paper[0] is not methods[0]:
        ratio = float(paper[0]["ratio_to_floor"])
        text += f"; {paper_results.METHOD}, the paper's method, reaches {ratio:.2f} times"
    return f"{text}."
