"""Tables as text (CSV, Markdown), and numbers as text."""

import csv
import io
from collections.abc import Iterable, Sequence
from itertools import takewhile
from pathlib import Path
from typing import Any


def csv_text(columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """A CSV of `columns` and `rows`; None is empty, a float has six digits."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        writer.writerow([f"{cell:.6g}" if isinstance(cell, float) else cell for cell in row])
    return text.getvalue()


def read_csv(path: Path) -> list[dict[str, str]]:
    """The rows of the CSV at `path`, by the names of the columns."""
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def markdown_table(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown."""
    table = [columns, ["---"] * len(columns), *rows]
    return "".join(f"| {' | '.join(row)} |\n" for row in table)


def read_markdown_table(path: Path) -> list[dict[str, str]]:
    """The rows of the Markdown table at the start of `path`, by the names of the columns."""
    heads, _, *rows = (
        line.removeprefix("| ").removesuffix(" |").split(" | ")
        for line in takewhile(
            lambda line: line.startswith("|"), path.read_text(encoding="utf-8").splitlines()
        )
    )
    return [dict(zip(heads, line, strict=True)) for line in rows]


def label_intervals(columns: Sequence[str], interval: float) -> list[str]:
    """`columns` with the confidence level `interval` in place of 95 %."""
    return [name.replace("95 %", f"{100 * interval:g} %") for name in columns]


def format_interval(low: float | None, high: float | None, format_spec: str) -> str:
    """`low to high`; empty where there is no interval, as of one family alone."""
    return "" if low is None or high is None else f"{low:{format_spec}} to {high:{format_spec}}"


def optional_float(cell: str | None) -> float | None:
    """A number of a CSV; None where the cell is empty or the table is older than the column."""
    return float(cell) if cell else None


def format_emd(emd: str, low: str, high: str) -> str:
    """Three cells of a CSV as `0.0614 (0.0542 to 0.0696)`; without an interval as `0.0614`."""
    interval = format_interval(optional_float(low), optional_float(high), ".4f")
    return f"{float(emd):.4f}" + (f" ({interval})" if interval else "")


def format_csv_number(cell: str | None) -> str:
    """A number of a CSV with three significant digits; an empty cell stays empty."""
    return f"{float(cell):#.3g}" if cell else ""


def format_fixed(value: float | None, digits: int = 4) -> str:
    """`value` with `digits` decimals; empty if None."""
    return "" if value is None else f"{value:.{digits}f}"


def format_significant(value: float | None) -> str:
    """`value` with three significant digits and no exponent; empty if None."""
    if value is None:
        return ""
    if abs(value) >= 100:
        return f"{value:.0f}"
    return f"{value:#.3g}" if abs(value) >= 1e-4 else f"{value:.2g}"
