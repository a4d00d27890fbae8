"""The published study in a few sentences, each made of its tables: what a reader asks first."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from industnerf.report.tables.formats import format_csv_number, markdown_table, read_csv

CsvRow = dict[str, str]
COMPARED_PAIRS = (  # pairs of comparisons.csv
    ("industnerf_plus", "hull"),
    ("industnerf_plus", "carve"),
    ("industnerf", "hull"),
    ("industnerf", "carve"),
)
SIGNIFICANCE_LEVEL = 0.05  # of p, after correction
VALUE_COLUMNS = ("value", "tsdf", "oracle")
GOAL_HEADERS = ("method", "goal", "wanted", "measured", "`tsdf`", "`oracle`")
COVERAGE_METHODS = ("industnerf_plus", "industnerf", "hull", "oracle")


def describe_findings(folder: Path, interval: str) -> str:
    """What the study in `folder` found, as a list in Markdown, and a table of the goals missed.

    Empty if the study has none of it.  `interval` is how sure its intervals are, as "95 %".
    """
    sentences = [
        *_comparison_sentences(read_csv(folder / "comparisons.csv"), interval),
        *_undertrained_sentence(read_csv(folder / "table1.csv")),
        *_coverage_sentence(read_csv(folder / "inspection.csv")),
    ]
    bullet_list = "".join(f"- {sentence}\n" for sentence in sentences)
    goals = _missed_goals(read_csv(folder / "goals.csv"), f"results/{folder.name}/goals.md")
    return "\n".join(filter(None, [bullet_list, goals]))


def _comparison_sentences(rows: Sequence[CsvRow], interval: str) -> Iterator[str]:
    known = {(row["method"], row["other"]): row for row in rows}
    for pair in COMPARED_PAIRS:
        if row := known.get(pair):
            yield _comparison_sentence(row, interval)


def _comparison_sentence(row: CsvRow, interval: str) -> str:
    names = ("difference", "ci_low", "ci_high", "difference_mm", "p_holm", "win_rate")
    difference, low, high, mm, p, wins = (float(row[name]) for name in names)
    direction = "lower" if difference < 0 else "higher"
    certainty = "" if p <= SIGNIFICANCE_LEVEL else ": not certain"
    return (
        f"`{row['method']}` has an EMD {abs(difference):.4f} {direction} than `{row['other']}` ({interval}: "
        f"{low:+.4f} to {high:+.4f}; in mm {mm:+.2f}; p {p:.2g} after Holm's correction{certainty}), "
        f"and is better on {100 * wins:.0f} % of the parts."
    )


def _undertrained_sentence(rows: Sequence[CsvRow]) -> Iterator[str]:
    """Nets that do not deserve their name, and why."""
    reasons = {r["method"]: r["undertrained"] for r in rows if r["split"] == "test"}
    phrases = [f"`{method}` ({reason})" for method, reason in reasons.items() if reason]
    if phrases:
        yield f"Nets that are weaker than they should be: {'; '.join(phrases)}."


def _coverage_sentence(rows: Sequence[CsvRow]) -> Iterator[str]:
    """How much of the surface is covered, in the language of inspection."""
    known = {
        row["method"]: row for row in rows if row.get("covered_0.5mm") and row.get("covered_1mm")
    }
    phrases = [
        f"`{method}` {100 * float(row['covered_0.5mm']):.0f} and "
        f"{100 * float(row['covered_1mm']):.0f} %"
        for method in COVERAGE_METHODS
        if (row := known.get(method))
    ]
    if phrases:
        yield f"Of the visible surface lie within 0.5 and 1 mm of the cloud: {', '.join(phrases)}."


def _missed_goals(rows: Sequence[CsvRow], link: str) -> str:
    missed = [row for row in rows if row["met"] == "no"]
    if not rows:
        return ""
    table_rows = [
        [
            f"`{row['method']}`",
            row["goal"],
            row["target"],
            *map(format_csv_number, map(row.get, VALUE_COLUMNS)),
        ]
        for row in missed
    ]
    count = f"{len(missed)} of {len(rows)} goals are missed ([all of them]({link}))"
    return f"{count}:\n\n{markdown_table(GOAL_HEADERS, table_rows)}" if missed else f"{count}.\n"
