"""docs/reference/scaling.md: seconds of every stage and method, and what they are on a cluster."""

from pathlib import Path
from statistics import fmean, median

from industnerf.errors import BadArtifact
from industnerf.report.publish.provenance import describe_provenance
from industnerf.report.statistics.comparisons import TESTED_METHODS
from industnerf.report.tables.costs import csv_seconds, seconds_label
from industnerf.report.tables.formats import format_fixed, markdown_table, read_csv

CsvRow = dict[str, str]
STAGES = {
    "views": "photographs",
    "truth": "truth and floors",
    "procedural": "procedural solids",
    "train": "training",
    "reconstruct": "reconstruction",
    "evaluate": "scoring",
    "solids": "reading CAD files",
    "parts": "cleaning meshes",
    "report": "the report",
}
CLUSTER_NODES, CLUSTER_PARTS = 64, 10_000


def costs_block(folder: Path) -> str:
    """Mean, median and most seconds of every stage and method; core minutes of each stage."""
    costs = read_csv(folder / "cost.csv")
    stage_methods = dict.fromkeys((row["stage"], row["method"]) for row in costs)
    table_rows = [
        [
            stage,
            f"`{method}`" if method else "",
            str(len(seconds)),
            *(format_fixed(statistic(seconds), 2) for statistic in (fmean, median, max)),
        ]
        for stage in STAGES
        for each_stage, method in stage_methods
        if each_stage == stage and (seconds := _seconds(costs, stage, method))
    ]
    heads = ["step", "method", "results", "mean, s", "median, s", "most, s"]
    return (
        f"{describe_provenance(folder)}. Times are {seconds_label(costs)}.\n\n"
        f"{_core_minutes(costs)}\n"
        f"{markdown_table(heads, table_rows)}"
    )


def _core_minutes(costs: list[CsvRow]) -> str:
    """Minutes of one core, by stage; drawing the held-out views is counted apart."""
    minutes = {name: sum(_seconds(costs, stage)) / 60 for stage, name in STAGES.items()}
    minutes["drawing held-out views"] = _extra_seconds(costs) / 60
    rows = [[name, f"{value:.0f}"] for name, value in minutes.items() if value]
    return markdown_table(
        ["what", "core minutes"], [*rows, ["all", f"{sum(minutes.values()):.0f}"]]
    )


def cluster_block(folder: Path) -> str:
    """What these seconds make of `CLUSTER_PARTS` parts on `CLUSTER_NODES` nodes.

    Raises BadArtifact if no cost is known.
    """
    costs = read_csv(folder / "cost.csv")
    parts = len({row["part_id"] for row in costs if row["stage"] == "views"})
    if not parts:
        raise BadArtifact(f"{folder / 'cost.csv'} knows no cost: the report found no store")
    methods = len({row["method"] for row in costs if row["stage"] == "reconstruct"})
    totals = {
        "photographs": sum(_seconds(costs, "views")),
        "truth and floors": sum(_seconds(costs, "truth")),
        **{
            f"`{name}`": sum(_seconds(costs, "reconstruct", name)) + _extra_seconds(costs, name)
            for name in TESTED_METHODS[::-1]
        },
        f"all {methods} methods": sum(_seconds(costs, "reconstruct")) + _extra_seconds(costs),
        "scoring them": sum(_seconds(costs, "evaluate")),
    }
    parts_text = f"{CLUSTER_PARTS:,}".replace(",", " ")
    table_rows = [
        [
            label,
            f"{parts_text} x {total / parts:.1f} s / {CLUSTER_NODES}",
            _format_duration(CLUSTER_PARTS * total / parts / CLUSTER_NODES),
        ]
        for label, total in totals.items()
    ]
    return markdown_table(["what", "arithmetic", "time"], table_rows)


def _format_duration(seconds: float) -> str:
    return f"{seconds / 60:.0f} min" if seconds < 3600 else f"{seconds / 3600:.1f} h"


def _extra_seconds(costs: list[CsvRow], method: str | None = None) -> float:
    """Seconds for drawing the held-out views."""
    return sum(csv_seconds(row, "extra_") for row in costs if method in (None, row["method"]))


def _seconds(costs: list[CsvRow], stage: str, method: str | None = None) -> list[float]:
    return [
        csv_seconds(row)
        for row in costs
        if row["stage"] == stage and method in (None, row["method"])
    ]
