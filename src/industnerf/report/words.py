"""The published study in a few sentences, each made of its tables: what a reader asks first."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from industnerf.report.formats import csv_rows, markdown, rounded

Cells = dict[str, str]
ASKED = (  # pairs of comparisons.csv
    ("industnerf_plus", "hull"),
    ("industnerf_plus", "carve"),
    ("industnerf", "hull"),
    ("industnerf", "carve"),
)
CERTAIN = 0.05  # of p, after correction
VALUES = ("value", "tsdf", "oracle")
GOALS = ("method", "goal", "wanted", "measured", "`tsdf`", "`oracle`")
COVERED = ("industnerf_plus", "industnerf", "hull", "oracle")


def in_words(folder: Path, interval: str) -> str:
    """What the study in `folder` found, as a list in Markdown, and a table of the goals missed.

    Empty if the study has none of it.  `interval` is how sure its intervals are, as "95 %".
    """
    said = [
        *_compared(csv_rows(folder / "comparisons.csv"), interval),
        *_nets(csv_rows(folder / "table1.csv")),
        *_inspected(csv_rows(folder / "inspection.csv")),
    ]
    listed = "".join(f"- {sentence}\n" for sentence in said)
    goals = _goals(csv_rows(folder / "goals.csv"), f"results/{folder.name}/goals.md")
    return "\n".join(filter(None, [listed, goals]))


def _compared(rows: Sequence[Cells], interval: str) -> Iterator[str]:
    known = {(row["method"], row["other"]): row for row in rows}
    for pair in ASKED:
        if row := known.get(pair):
            yield _comparison(row, interval)


def _comparison(row: Cells, interval: str) -> str:
    names = ("difference", "ci_low", "ci_high", "difference_mm", "p_holm", "win_rate")
    off, low, high, mm, p, wins = (float(row[name]) for name in names)
    way = "lower" if off < 0 else "higher"
    sure = "" if p <= CERTAIN else ": not certain"
    return (
        f"`{row['method']}` has an EMD {abs(off):.4f} {way} than `{row['other']}` ({interval}: "
        f"{low:+.4f} to {high:+.4f}; in mm {mm:+.2f}; p {p:.2g} after Holm's correction{sure}), "
        f"and is better on {100 * wins:.0f} % of the parts."
    )


def _nets(rows: Sequence[Cells]) -> Iterator[str]:
    """Nets that do not deserve their name, and why."""
    weak = {r["method"]: r["undertrained"] for r in rows if r["split"] == "test"}
    said = [f"`{method}` ({why})" for method, why in weak.items() if why]
    if said:
        yield f"Nets that are weaker than they should be: {'; '.join(said)}."


def _inspected(rows: Sequence[Cells]) -> Iterator[str]:
    """How much of the surface is covered, in the language of inspection."""
    known = {
        row["method"]: row for row in rows if row.get("covered_0.5mm") and row.get("covered_1mm")
    }
    said = [
        f"`{method}` {100 * float(row['covered_0.5mm']):.0f} and "
        f"{100 * float(row['covered_1mm']):.0f} %"
        for method in COVERED
        if (row := known.get(method))
    ]
    if said:
        yield f"Of the visible surface lie within 0.5 and 1 mm of the cloud: {', '.join(said)}."


def _goals(rows: Sequence[Cells], link: str) -> str:
    missed = [row for row in rows if row["met"] == "no"]
    if not rows:
        return ""
    lines = [
        [f"`{row['method']}`", row["goal"], row["wanted"], *map(rounded, map(row.get, VALUES))]
        for row in missed
    ]
    count = f"{len(missed)} of {len(rows)} goals are missed ([all of them]({link}))"
    return f"{count}:\n\n{markdown(GOALS, lines)}" if missed else f"{count}.\n"
