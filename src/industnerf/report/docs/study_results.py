"""Published results as Markdown: five rows for the README, all tables for a page of their own."""

from collections import defaultdict
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import fmean

from industnerf.report import paper_results
from industnerf.report.docs.changed_settings import changed_settings
from industnerf.report.publish.provenance import describe_provenance, read_provenance
from industnerf.report.tables.costs import csv_seconds, seconds_label
from industnerf.report.tables.formats import (
    format_csv_number,
    format_fixed,
    format_interval,
    format_significant,
    markdown_table,
    optional_float,
    read_csv,
    read_markdown_table,
)
from industnerf.report.tables.table2 import LOSSES

CsvRow = dict[str, str]
README_METHODS = ("oracle", "industnerf_plus", "carve", "industnerf")  # and the best network
COMPARED_PAIRS = (
    ("industnerf_plus", "hull"),
    ("industnerf_plus", "carve"),
    ("industnerf", "hull"),
    ("industnerf", "carve"),
)
COVERAGE_METHODS = ("industnerf_plus", "industnerf", "carve", "hull", "oracle")
TOLERANCE_COLUMNS = {"covered_0.5mm": "surface within 0.5 mm", "covered_1mm": "surface within 1 mm"}
GOAL_COLUMNS = {"value": "measured", "tsdf": "`tsdf`", "oracle": "`oracle`"}
OLDER_THAN_SETTINGS = (
    "Some settings have changed since, so a new run has other numbers "
    "([which](docs/results/study.md))."
)


def readme_block(folder: Path, params: Path) -> str:
    """The rows of `README_METHODS` and of the best network, and where they come from.

    `params`: today's params.yaml; that it differs from the study's is said.
    """
    rows = test_rows(folder)
    networks = [row for row in rows if row["size"]]
    best_network = min(networks, key=lambda row: float(row["emd_even"]), default={"method": ""})
    shown = [row for row in rows if row["method"] in (*README_METHODS, best_network["method"])]
    columns = ("method", "inputs", "EMD", "x floor", _seconds_label(folder), "paper")
    note = f"\n{OLDER_THAN_SETTINGS}\n" if changed_settings(folder / "params.yaml", params) else ""
    return f"{_describe_results(folder)}{_table1(folder, shown, columns)}{note}"


def results_block(folder: Path, params: Path | None = None, with_paper_tables: bool = False) -> str:
    """All methods of the results in `folder`, their comparisons, coverage and missed goals.

    `with_paper_tables`: the paper's two tables come first.

    `params`: today's params.yaml; what has changed in it since is named.
    """
    interval = _interval_label(folder)
    columns = (
        *("method", "inputs", "EMD", interval, "mm", "x floor", "failed", _seconds_label(folder)),
        "paper",
    )
    paper_tables = {
        "The paper's Table 1": _paper_table1(folder),
        "The paper's Table 2": _paper_table2(read_csv(folder / "table2.csv")),
    }
    sections: dict[str, str] = {
        **(paper_tables if with_paper_tables else {}),
        "All methods": _table1(folder, test_rows(folder), columns) + _undertrained_list(folder),
        "Held-out views": _table2(read_csv(folder / "table2.csv")),
        "Comparisons": _comparison_table(read_csv(folder / "comparisons.csv"), interval),
        "Surface within tolerance": _coverage_table(read_csv(folder / "inspection.csv")),
        "Goals": _missed_goals(folder),
    }
    tables = "\n".join(f"## {title}\n\n{text}" for title, text in sections.items() if text)
    changes = changed_settings(folder / "params.yaml", params) if params else ""
    return f"{_describe_results(folder)}{changes}{tables}"


def table1_cells(folder: Path) -> dict[str, CsvRow]:
    """Method -> its cells of `table1.md`: rounding the CSV again may give another digit."""
    rows = read_markdown_table(folder / "table1.md")
    return {row["method"]: row for row in rows if row["split"] == "test"}


def _describe_results(folder: Path) -> str:
    scores = [row for row in read_csv(folder / "scores.csv") if row["split"] == "test"]
    parts, families = (len({row[name] for row in scores}) for name in ("part_id", "family"))
    return (
        f"{parts} test parts of {families} families, {describe_provenance(folder)}. "
        f"Every number is in `results/{folder.name}`.\n\n"
    )


def _interval_label(folder: Path) -> str:
    """The confidence level of the intervals, such as `95 %`."""
    return f"{100 * read_provenance(folder)['interval']:g} %"


def test_rows_by_method(folder: Path) -> dict[str, CsvRow]:
    return {row["method"]: row for row in test_rows(folder)}


def test_rows(folder: Path) -> list[CsvRow]:
    return [row for row in read_csv(folder / "table1.csv") if row["split"] == "test"]


def _table1(folder: Path, rows: Sequence[CsvRow], columns: Sequence[str]) -> str:
    """The named columns of Table 1."""
    seconds, interval, table = mean_seconds(folder), _interval_label(folder), table1_cells(folder)
    cells: dict[str, Callable[[CsvRow], str]] = {
        "method": lambda row: row["method"] + (" (undertrained)" if row["undertrained"] else ""),
        "inputs": lambda row: row["inputs"],
        "EMD": lambda row: table[row["method"]]["EMD (even)"],
        interval: lambda row: table[row["method"]][interval],
        "mm": lambda row: table[row["method"]]["EMD, mm"],
        "x floor": lambda row: table[row["method"]]["x floor"],
        "failed": lambda row: table[row["method"]]["failed"],
        _seconds_label(folder): lambda row: format_fixed(seconds.get(row["method"]), 1),
        "paper": lambda row: format_fixed(float(row["paper_emd"])) if row["paper_emd"] else "",
    }
    return markdown_table(columns, [[cells[name](row) for name in columns] for row in rows])


def _paper_table1(folder: Path) -> str:
    """The four rows of the paper, the numbers of `folder` beside; empty if none of them ran."""
    rows, table = test_rows_by_method(folder), table1_cells(folder)
    table_rows = [
        [
            f"{name} (`{method}`)",
            f"{paper_results.EMD[method]:.4f}",
            table[method]["EMD (even)"],
            table[method][_interval_label(folder)],
            "undertrained" if rows[method]["undertrained"] else "",
        ]
        for method, name in paper_results.MODELS.items()
        if method in rows
    ]
    heads = ["model", "EMD in the paper", "EMD here", _interval_label(folder), "mark"]
    return markdown_table(heads, table_rows) if table_rows else ""


def _paper_table2(rows: Sequence[CsvRow]) -> str:
    """The paper's losses of its own method, on all test parts; empty if it did not run."""
    values = {
        row["loss"]: row["value"]
        for row in rows
        if (row["method"], row["subset"]) == (paper_results.METHOD, "all")
        and not row["unit"].startswith("mm")
    }
    table_rows = [
        [
            loss.name,
            format_significant(paper_results.TABLE2[loss.metric]),
            format_csv_number(values[loss.metric]),
        ]
        for loss in LOSSES
        if loss.metric in values
    ]
    return markdown_table(["loss", "in the paper", "here"], table_rows) if table_rows else ""


def _seconds_label(folder: Path) -> str:
    return seconds_label(read_csv(folder / "cost.csv"))


def mean_seconds(folder: Path) -> dict[str, float]:
    """Mean seconds of each method for one test part."""
    parts = {row["part_id"] for row in read_csv(folder / "scores.csv") if row["split"] == "test"}
    seconds_by_method = defaultdict(list)
    for row in read_csv(folder / "cost.csv"):
        if row["stage"] == "reconstruct" and row["part_id"] in parts:
            seconds_by_method[row["method"]].append(csv_seconds(row))
    return {method: fmean(seconds) for method, seconds in seconds_by_method.items()}


def _undertrained_list(folder: Path) -> str:
    """The networks that are marked as undertrained, and why."""
    reasons = [
        f"- `{row['method']}`: {row['undertrained']}"
        for row in test_rows(folder)
        if row["undertrained"]
    ]
    return "\n".join(["\nUndertrained networks:", "", *reasons, ""]) if reasons else ""


def _table2(rows: Sequence[CsvRow]) -> str:
    """A row per method and loss, a column per subset of parts; empty if no method renders."""
    values = {(*_method_and_loss(row), row["subset"]): row["value"] for row in rows}
    coverage = {
        _method_and_loss(row): row.get("coverage") for row in rows if row["subset"] == "all"
    }
    table_rows = [
        [
            *key,
            *(format_csv_number(values.get((*key, name))) for name in ("all", "figure3")),
            format_csv_number(paper_value),
            *([format_csv_number(coverage.get(key))] if any(coverage.values()) else []),
        ]
        for key, paper_value in {_method_and_loss(row): row["paper"] for row in rows}.items()
    ]
    heads = ["method", "loss", "all test parts", "one a family", "paper"]
    heads += ["coverage"] if any(coverage.values()) else []
    return markdown_table(heads, table_rows) if rows else ""


def _method_and_loss(row: CsvRow) -> tuple[str, str]:
    """The method, and the loss in words; in mm with its unit."""
    name = next(loss.name for loss in LOSSES if loss.metric == row["loss"])
    return row["method"], name + {"mm": ", mm", "mm^2": ", mm²"}.get(row["unit"], "")


def _comparison_table(rows: Sequence[CsvRow], interval: str) -> str:
    """Paired differences of EMD for `COMPARED_PAIRS`; below 0 the first method is better."""
    known = {(row["method"], row["other"]): row for row in rows}
    names = ("difference", "difference_mm", "p_holm", "win_rate")
    table_rows = []
    for pair in (pair for pair in COMPARED_PAIRS if pair in known):
        difference, mm, p, wins = (float(known[pair][name]) for name in names)
        low, high = (optional_float(known[pair][name]) for name in ("ci_low", "ci_high"))
        table_rows.append(
            [
                *(f"`{method}`" for method in pair),
                f"{difference:+.4f}",
                format_interval(low, high, "+.4f"),
                f"{mm:+.2f}",
                f"{p:.2g}",
                f"{100 * wins:.0f} %",
            ]
        )
    heads = ["method", "against", "EMD difference", interval, "mm", "p (Holm)", "better on"]
    return markdown_table(heads, table_rows) if table_rows else ""


def _coverage_table(rows: Sequence[CsvRow]) -> str:
    """The share of the visible surface within each tolerance of the cloud."""
    known = {row["method"]: row for row in rows if all(map(row.get, TOLERANCE_COLUMNS))}
    table_rows = [
        [
            f"`{method}`",
            *(f"{100 * float(known[method][name]):.0f} %" for name in TOLERANCE_COLUMNS),
        ]
        for method in COVERAGE_METHODS
        if method in known
    ]
    return markdown_table(["method", *TOLERANCE_COLUMNS.values()], table_rows) if table_rows else ""


def _missed_goals(folder: Path) -> str:
    rows = read_csv(folder / "goals.csv")
    missed = [row for row in rows if row["met"] == "no"]
    if not rows:
        return ""
    table_rows = [
        [
            f"`{row['method']}`",
            row["goal"],
            row["target"],
            *(format_csv_number(row[name]) for name in GOAL_COLUMNS),
        ]
        for row in missed
    ]
    heads = ["method", "goal", "target", *GOAL_COLUMNS.values()]
    table = f"\n{markdown_table(heads, table_rows)}" if missed else ""
    where = f"All are in `results/{folder.name}/goals.md`."
    return f"{len(missed)} of {len(rows)} goals are missed. {where}\n{table}"
