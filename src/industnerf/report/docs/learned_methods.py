"""docs/reference/baselines.md: methods that learn from other parts, and the effect of leakage."""

from collections.abc import Sequence
from pathlib import Path
from statistics import fmean

from industnerf.errors import BadArtifact
from industnerf.report import paper_results
from industnerf.report.docs.study_results import table1_cells
from industnerf.report.publish.provenance import describe_provenance
from industnerf.report.tables.costs import csv_seconds
from industnerf.report.tables.formats import (
    format_emd,
    format_fixed,
    format_significant,
    markdown_table,
    read_csv,
)
from industnerf.report.tables.scores import EMD_EVEN

CsvRow = dict[str, str]
BASELINE_HEADERS = {"retrieval": "better than retrieval on", "mean_shape": "than the mean shape on"}
HOLD_OUT_HEADERS = {"family": "families held out", "part": "families seen", "none": "parts seen"}
SAME_EMD_TOLERANCE = 1e-5  # the last digit of sweep.csv


def networks_block(folder: Path) -> str:
    """Every method that learns from other parts, beside the baselines that it must beat."""
    rows = [row for row in read_csv(folder / "table1.csv") if row["split"] == "test"]
    paper_method_row = next((row for row in rows if row["method"] == paper_results.METHOD), None)
    minutes, emds = _mean_train_minutes(folder), _emd_even(folder)
    table_rows = [
        [
            f"`{row['method']}`",
            row["size"],
            row["parameters"] if row["size"] else "",
            minutes.get(row["method"], ""),
            row["steps"] if row["size"] else "",
            format_emd(*(row[name] for name in ("emd_even", "ci_low", "ci_high"))),
            format_significant(float(row["emd_mm"])),
            *(_relative_emd(row, paper_method_row) if paper_method_row else ("", "")),
            *(_win_rate(emds, row["method"], baseline) for baseline in BASELINE_HEADERS),
        ]
        for row in rows
        if int(row["num_train_parts"])
    ]
    heads = ["method", "size", "parameters", "minutes", "most steps", "EMD", "mm"]
    heads += [f"x `{paper_results.METHOD}`", "paper, x its own", *BASELINE_HEADERS.values()]
    return f"{describe_provenance(folder)}.\n\n{markdown_table(heads, table_rows)}"


def _mean_train_minutes(folder: Path) -> dict[str, str]:
    """Mean minutes of a training, by method."""
    rows = [row for row in read_csv(folder / "cost.csv") if row["stage"] == "train"]
    return {
        method: format_fixed(
            fmean(csv_seconds(row) / 60 for row in rows if row["method"] == method), 1
        )
        for method in {row["method"] for row in rows}
    }


def _relative_emd(row: CsvRow, paper_method_row: CsvRow) -> tuple[str, str]:
    """The EMD over that of the paper's method: here, and in the paper beside the paper's number."""
    ratio = format_fixed(float(row["emd_even"]) / float(paper_method_row["emd_even"]), 2)
    if not row["paper_emd"]:
        return ratio, ""
    paper_emd = float(row["paper_emd"])
    return ratio, f"{paper_emd:.4f}, {paper_emd / float(paper_method_row['paper_emd']):.2f}"


def _emd_even(folder: Path) -> dict[tuple[str, str], float]:
    """EMD (even) of each test part, by method and part."""
    return {
        (row["method"], row["part_id"]): float(row["value"])
        for row in read_csv(folder / "scores.csv")
        if row["split"] == "test" and (row["metric"], row["protocol"]) == EMD_EVEN
    }


def _win_rate(emds: dict[tuple[str, str], float], method: str, baseline: str) -> str:
    """The share of parts on which `method` has the lower EMD; empty for a baseline itself."""
    value_pairs = [
        (emds[method, p], emds[m, p]) for m, p in emds if m == baseline and (method, p) in emds
    ]
    if not value_pairs or method in BASELINE_HEADERS:
        return ""
    return f"{100 * fmean(a < b for a, b in value_pairs):.0f} %"


def leakage_block(sweep: Path, study: Path) -> str:
    """EMD by what is held out of training, the floor first; mm where the study measured the same.

    Raises BadArtifact as `read_leakage_sweep` does.
    """
    results = read_leakage_sweep(sweep)
    study_values = _study_values(study, results)
    heads = [head for hold_out in HOLD_OUT_HEADERS.values() for head in (hold_out, "x floor")]
    heads.insert(1, "mm")
    floors = [
        cell for hold_out in HOLD_OUT_HEADERS for cell in (_mean_floor(results, hold_out), "1")
    ]
    table_rows = [["floor", floors[0], "", *floors[1:]]]
    for method in dict.fromkeys(method for method, _ in results):
        rows = [results[method, hold_out] for hold_out in HOLD_OUT_HEADERS]
        first, ratio, *others = [
            cell
            for row in rows
            for cell in (
                format_emd(*(row[name] for name in ("emd", "low", "high"))),
                f"{float(row['x floor']):.2f}",
            )
        ]
        table_rows.append([f"`{method}`", first, *study_values.get(method, ("", ratio)), *others])
    return markdown_table(["method", *heads], table_rows)


def read_leakage_sweep(sweep: Path) -> dict[tuple[str, str], CsvRow]:
    """The rows of the test parts by method and what was held out.

    Raises BadArtifact if a method was not measured at every point.
    """
    rows = [row for row in read_csv(sweep / "sweep.csv") if row["split"] == "test"]
    results = {(row["method"], row["split.hold_out"]): row for row in rows}
    for method, _ in results:
        for hold_out in HOLD_OUT_HEADERS:
            if (method, hold_out) not in results:
                raise BadArtifact(
                    f"{sweep / 'sweep.csv'} has no {method} at split.hold_out {hold_out}: publish "
                    "a sweep with the same methods at every point, or keep the one before"
                )
    return results


def _mean_floor(results: dict[tuple[str, str], CsvRow], hold_out: str) -> str:
    """The floor is of the truth alone: the same for every method."""
    rows: Sequence[CsvRow] = [row for (_, held_out), row in results.items() if held_out == hold_out]
    return f"{fmean(float(row['emd']) / float(row['x floor']) for row in rows):.4f}"


def _study_values(
    study: Path, results: dict[tuple[str, str], CsvRow]
) -> dict[str, tuple[str, str]]:
    """The mm and x floor of each method whose EMD the study and the sweep agree on."""
    cells_by_method = table1_cells(study)
    return {
        row["method"]: tuple(
            cells_by_method[row["method"]][name] for name in ("EMD, mm", "x floor")
        )
        for row in read_csv(study / "table1.csv")
        if row["split"] == "test"
        and (sweep_row := results.get((row["method"], "family")))
        and abs(float(row["emd_even"]) - float(sweep_row["emd"])) < SAME_EMD_TOLERANCE
    }
