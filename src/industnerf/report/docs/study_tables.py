"""What the documents show of the published study: made of its files, as the README's tables are."""

from collections.abc import Sequence
from pathlib import Path
from statistics import fmean, median

from industnerf.errors import BadArtifact
from industnerf.report import paper_results
from industnerf.report.publish.provenance import describe_provenance
from industnerf.report.statistics.comparisons import TESTED_METHODS
from industnerf.report.tables.formats import (
    format_fixed,
    format_significant,
    markdown_table,
    read_csv,
)
from industnerf.report.tables.scores import EMD_EVEN

CsvRow = dict[str, str]
BASELINE_HEADERS = {"retrieval": "better than retrieval on", "mean_shape": "than the mean shape on"}
MEAN_COLUMNS = ("emd_even", "ci_low", "ci_high")
MAIN_STAGES = ("views", "truth", "train", "reconstruct", "evaluate")
OTHER_STAGES = {"solids": "reading CAD files", "parts": "cleaning meshes", "report": "the report"}
SHOWN_STAGES = (*MAIN_STAGES, *OTHER_STAGES)
CLUSTER_NODES, CLUSTER_PARTS = 64, 10_000  # of docs/scaling.md


def nets_block(folder: Path) -> str:
    """docs/baselines.md: every method that learns from other parts, against those it must beat."""
    rows = [row for row in read_csv(folder / "table1.csv") if row["split"] == "test"]
    paper_method_row = next((row for row in rows if row["method"] == paper_results.METHOD), None)
    costs, emds = read_csv(folder / "cost.csv"), _emd_even(folder)
    heads = [
        "method",
        "size",
        "numbers",
        "minutes",
        "most steps",
        "EMD",
        "mm",
        f"x `{paper_results.METHOD}`",
    ]
    table_rows = [
        [
            f"`{row['method']}`",
            row["size"],
            row["parameters"] if row["size"] else "",
            _mean_minutes(_seconds(costs, "train", row["method"])),
            row["steps"] if row["size"] else "",
            "{:.4f} ({:.4f} to {:.4f})".format(*(float(row[name]) for name in MEAN_COLUMNS)),
            format_significant(float(row["emd_mm"])),
            *(_relative_emd(row, paper_method_row) if paper_method_row else ("", "")),
            *(_win_rate(emds, row["method"], baseline) for baseline in BASELINE_HEADERS),
        ]
        for row in rows
        if int(row["num_train_parts"])
    ]
    heads += ["paper, x its own", *BASELINE_HEADERS.values()]
    return f"On {describe_provenance(folder)}.\n\n{markdown_table(heads, table_rows)}"


def _relative_emd(row: CsvRow, paper_method_row: CsvRow) -> tuple[str, str]:
    """How much worse than the paper's method it is: here, and in the paper_results, beside its number."""
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
    """On how many of the parts `method` has the lower EMD; nothing if it is a rival itself."""
    value_pairs = [
        (emds[method, p], emds[m, p]) for m, p in emds if m == baseline and (method, p) in emds
    ]
    return (
        f"{100 * fmean(a < b for a, b in value_pairs):.0f} %"
        if value_pairs and method not in BASELINE_HEADERS
        else ""
    )


def costs_block(folder: Path) -> str:
    """docs/scaling.md: seconds of every step and method, and what all of it took."""
    costs = read_csv(folder / "cost.csv")
    stage_methods = dict.fromkeys(
        (row["stage"], row["method"]) for row in costs if row["stage"] in SHOWN_STAGES
    )
    table_rows = [
        [stage, f"`{method}`" if method else "", str(len(seconds)), *_mean_median_max(seconds)]
        for stage, method in sorted(
            stage_methods, key=lambda stage_method: SHOWN_STAGES.index(stage_method[0])
        )
        if (seconds := _seconds(costs, stage, method))
    ]
    heads = ["step", "method", "results", "mean, s", "median, s", "most, s"]
    return f"On {describe_provenance(folder)}.\n{_total_minutes(costs)}\n\n{markdown_table(heads, table_rows)}"


def _mean_median_max(seconds: list[float]) -> list[str]:
    return [format_fixed(statistic(seconds), 2) for statistic in (fmean, median, max)]


def _total_minutes(costs: list[CsvRow]) -> str:
    """Minutes of one core, by step."""
    views, truth, train, reconstruct, evaluate = (
        sum(_seconds(costs, stage)) / 60 for stage in MAIN_STAGES
    )
    extra = _extra_seconds(costs) / 60
    other = sum(sum(_seconds(costs, stage)) for stage in OTHER_STAGES) / 60
    other_names = [
        name for stage, name in OTHER_STAGES.items() if _seconds(costs, stage)
    ]  # not all, of older studies
    return (
        f"All of it is {views + truth + train + reconstruct + extra + evaluate + other:.0f} minutes of one "
        "core: "
        f"{views:.0f} for photographs, {truth:.0f} for truth and floors,\n"
        f"{train:.0f} for training, {reconstruct:.0f} for reconstruction and {extra:.0f} for its pictures "
        f"of the held-out views, {evaluate:.0f} for scoring"
        + (f",\n{other:.0f} for {_join_words(other_names)}." if other_names else ".")
    )


def _join_words(items: Sequence[str]) -> str:
    """Such as `one, two and three`."""
    *first, last = items
    return f"{', '.join(first)} and {last}" if first else last


def cluster_block(folder: Path) -> str:
    """docs/scaling.md: what that makes of 10 000 parts on 64 nodes."""
    costs = read_csv(folder / "cost.csv")
    parts = len({row["part_id"] for row in costs if row["stage"] == "views"})
    if not parts:
        raise BadArtifact(f"{folder / 'cost.csv'} knows no cost: the report found no store")
    methods = len({row["method"] for row in costs if row["stage"] == "reconstruct"})
    totals = {
        "photographs": sum(_seconds(costs, "views")),
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


def _mean_minutes(seconds: list[float]) -> str:
    """Their mean; nothing where the store knew none."""
    return format_fixed(fmean(seconds) / 60, 1) if seconds else ""


def _format_duration(seconds: float) -> str:
    return f"{seconds / 60:.0f} min" if seconds < 3600 else f"{seconds / 3600:.1f} h"


def _extra_seconds(costs: list[CsvRow], method: str | None = None) -> float:
    """Seconds for the pictures of held-out views."""
    return sum(float(row["extra_seconds"]) for row in costs if method in (None, row["method"]))


def _seconds(costs: list[CsvRow], stage: str, method: str | None = None) -> list[float]:
    return [
        float(row["seconds"])
        for row in costs
        if row["stage"] == stage and method in (None, row["method"])
    ]
