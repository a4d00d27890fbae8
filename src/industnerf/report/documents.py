"""What the documents show of the published study: made of its files, as the README's tables are."""

from collections.abc import Sequence
from pathlib import Path
from statistics import fmean, median

from industnerf.errors import BadArtifact
from industnerf.report import paper
from industnerf.report.comparisons import TESTED
from industnerf.report.formats import brief, csv_rows, markdown, short
from industnerf.report.lookup import EVEN
from industnerf.report.provenance import made_where

Cells = dict[str, str]
RIVALS = {"retrieval": "better than retrieval on", "mean_shape": "than the mean shape on"}
MEAN = ("emd_even", "ci_low", "ci_high")
STEPS = ("views", "truth", "train", "reconstruct", "evaluate")
AROUND = {"solids": "reading CAD files", "parts": "cleaning meshes", "report": "the report"}
SHOWN = (*STEPS, *AROUND)
NODES, PARTS = 64, 10_000  # of docs/scaling.md


def nets_block(folder: Path) -> str:
    """docs/baselines.md: every method that learns from other parts, against those it must beat."""
    rows = [row for row in csv_rows(folder / "table1.csv") if row["split"] == "test"]
    ours = next((row for row in rows if row["method"] == paper.METHOD), None)
    costs, even = csv_rows(folder / "cost.csv"), _even(folder)
    heads = [
        "method",
        "size",
        "numbers",
        "minutes",
        "most steps",
        "EMD",
        "mm",
        f"x `{paper.METHOD}`",
    ]
    lines = [
        [
            f"`{row['method']}`",
            row["size"],
            row["parameters"] if row["size"] else "",
            _minutes(_seconds(costs, "train", row["method"])),
            row["steps"] if row["size"] else "",
            "{:.4f} ({:.4f} to {:.4f})".format(*(float(row[name]) for name in MEAN)),
            brief(float(row["emd_mm"])),
            *(_to_ours(row, ours) if ours else ("", "")),
            *(_wins(even, row["method"], rival) for rival in RIVALS),
        ]
        for row in rows
        if int(row["learned_from"])
    ]
    heads += ["paper, x its own", *RIVALS.values()]
    return f"On {made_where(folder)}.\n\n{markdown(heads, lines)}"


def _to_ours(row: Cells, ours: Cells) -> tuple[str, str]:
    """How much worse than the paper's method it is: here, and in the paper, beside its number."""
    here = short(float(row["emd_even"]) / float(ours["emd_even"]), 2)
    if not row["paper_emd"]:
        return here, ""
    paper = float(row["paper_emd"])
    return here, f"{paper:.4f}, {paper / float(ours['paper_emd']):.2f}"


def _even(folder: Path) -> dict[tuple[str, str], float]:
    """EMD (even) of each test part, by method and part."""
    return {
        (row["method"], row["part_id"]): float(row["value"])
        for row in csv_rows(folder / "scores.csv")
        if row["split"] == "test" and (row["metric"], row["protocol"]) == EVEN
    }


def _wins(even: dict[tuple[str, str], float], method: str, rival: str) -> str:
    """On how many of the parts `method` has the lower EMD; nothing if it is a rival itself."""
    both = [(even[method, p], even[m, p]) for m, p in even if m == rival and (method, p) in even]
    return f"{100 * fmean(a < b for a, b in both):.0f} %" if both and method not in RIVALS else ""


def costs_block(folder: Path) -> str:
    """docs/scaling.md: seconds of every step and method, and what all of it took."""
    costs = csv_rows(folder / "cost.csv")
    kinds = dict.fromkeys((row["stage"], row["method"]) for row in costs if row["stage"] in SHOWN)
    lines = [
        [stage, f"`{method}`" if method else "", str(len(found)), *_spread(found)]
        for stage, method in sorted(kinds, key=lambda kind: SHOWN.index(kind[0]))
        if (found := _seconds(costs, stage, method))
    ]
    heads = ["step", "method", "results", "mean, s", "median, s", "most, s"]
    return f"On {made_where(folder)}.\n{_whole(costs)}\n\n{markdown(heads, lines)}"


def _spread(seconds: list[float]) -> list[str]:
    return [short(of(seconds), 2) for of in (fmean, median, max)]


def _whole(costs: list[Cells]) -> str:
    """Minutes of one core, by step."""
    views, truth, train, made, scored = (sum(_seconds(costs, step)) / 60 for step in STEPS)
    aside = _aside(costs) / 60
    around = sum(sum(_seconds(costs, step)) for step in AROUND) / 60
    known = [
        what for step, what in AROUND.items() if _seconds(costs, step)
    ]  # not all, of older studies
    return (
        f"All of it is {views + truth + train + made + aside + scored + around:.0f} minutes of one "
        "core: "
        f"{views:.0f} for photographs, {truth:.0f} for truth and floors,\n"
        f"{train:.0f} for training, {made:.0f} for reconstruction and {aside:.0f} for its pictures "
        f"of the held-out views, {scored:.0f} for scoring"
        + (f",\n{around:.0f} for {_listed(known)}." if known else ".")
    )


def _listed(words: Sequence[str]) -> str:
    """Such as `one, two and three`."""
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last


def cluster_block(folder: Path) -> str:
    """docs/scaling.md: what that makes of 10 000 parts on 64 nodes."""
    costs = csv_rows(folder / "cost.csv")
    parts = len({row["part_id"] for row in costs if row["stage"] == "views"})
    if not parts:
        raise BadArtifact(f"{folder / 'cost.csv'} knows no cost: the report found no store")
    methods = len({row["method"] for row in costs if row["stage"] == "reconstruct"})
    each = {
        "photographs": sum(_seconds(costs, "views")),
        **{
            f"`{name}`": sum(_seconds(costs, "reconstruct", name)) + _aside(costs, name)
            for name in TESTED[::-1]
        },
        f"all {methods} methods": sum(_seconds(costs, "reconstruct")) + _aside(costs),
        "scoring them": sum(_seconds(costs, "evaluate")),
    }
    many = f"{PARTS:,}".replace(",", " ")
    lines = [
        [what, f"{many} x {total / parts:.1f} s / {NODES}", _time(PARTS * total / parts / NODES)]
        for what, total in each.items()
    ]
    return markdown(["what", "arithmetic", "time"], lines)


def _minutes(seconds: list[float]) -> str:
    """Their mean; nothing where the store knew none."""
    return short(fmean(seconds) / 60, 1) if seconds else ""


def _time(seconds: float) -> str:
    return f"{seconds / 60:.0f} min" if seconds < 3600 else f"{seconds / 3600:.1f} h"


def _aside(costs: list[Cells], method: str | None = None) -> float:
    """Seconds for the pictures of held-out views."""
    return sum(float(row["aside_s"]) for row in costs if method in (None, row["method"]))


def _seconds(costs: list[Cells], stage: str, method: str | None = None) -> list[float]:
    return [
        float(row["seconds"])
        for row in costs
        if row["stage"] == stage and method in (None, row["method"])
    ]
