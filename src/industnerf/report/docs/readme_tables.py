"""Tables for the README, made of what is published: only the columns that a reader needs there."""

from collections import defaultdict
from collections.abc import Set
from itertools import accumulate
from pathlib import Path
from statistics import fmean

from industnerf.config import flatten, read_yaml
from industnerf.report.docs.findings import describe_findings
from industnerf.report.publish.provenance import describe_provenance, read_provenance
from industnerf.report.tables.formats import (
    format_csv_number,
    format_fixed,
    markdown_table,
    read_csv,
    read_markdown_table,
)
from industnerf.report.tables.table2 import LOSSES

CsvRow = dict[str, str]


def study_block(folder: Path, params: Path) -> str:
    """Tables 1 and 2 of the study published in `folder`, what it found, and where it comes from.

    `params` is params.yaml as it is now: what has changed in it since is named.
    """
    return (
        f"{_describe_study(folder)}{_table1(folder)}"
        f"{_table2(read_csv(folder / 'table2.csv'))}"
        f"{_findings(folder)}"
        f"{_changes_since(folder / 'params.yaml', params)}"
    )


def demo_block(folder: Path) -> str:
    """Table 1 of the demo published in `folder`, and where it comes from."""
    return f"{_describe_study(folder)}{_table1(folder)}"


def _describe_study(folder: Path) -> str:
    scores = _scores(folder)
    parts, families = (len({row[name] for row in scores}) for name in ("part_id", "family"))
    where = f"results/{folder.name}"
    return (
        f"{parts} test parts of {families} families, {describe_provenance(folder)}; every number "
        f"is in [{where}]({where}).\n\n"
    )


def _scores(folder: Path) -> list[CsvRow]:
    return [row for row in read_csv(folder / "scores.csv") if row["split"] == "test"]


def _interval_label(folder: Path) -> str:
    """How sure the intervals are."""
    return f"{100 * read_provenance(folder)['interval']:g} %"


def _findings(folder: Path) -> str:
    findings = describe_findings(folder, _interval_label(folder))
    return f"\n{findings}" if findings else ""


def _changes_since(published_params: Path, current_params: Path) -> str:
    """A sentence on what of params.yaml is no longer as the study had it, or nothing."""
    old, new = (flatten(read_yaml(path)) for path in (published_params, current_params))
    changed = {key for key in old.keys() & new.keys() if old[key] != new[key]}
    changes = {
        "has changed in": {".".join(key.split(".")[:3]) for key in changed},
        "has gained": _only_in(new.keys(), old.keys()),
        "has lost": _only_in(old.keys(), new.keys()),
    }
    clauses = [f"{verb} {_code_list(keys)}" for verb, keys in changes.items() if keys]
    return f"\nSince then params.yaml {' and '.join(clauses)}.\n" if clauses else ""


def _only_in(these: Set[str], those: Set[str]) -> set[str]:
    """Keys of `these` that are not in `those`: where a whole section is not, the section."""
    known = {section for key in those for section in _sections(key)}
    return {next((s for s in _sections(key) if s not in known), key) for key in these - those}


def _sections(key: str) -> list[str]:
    """What `key` is in, from the widest to itself: a, a.b, a.b.c."""
    return list(accumulate(key.split("."), "{}.{}".format))


def _code_list(keys: Set[str]) -> str:
    return ", ".join(f"`{key}`" for key in sorted(keys))


def _mean_seconds(folder: Path, parts: set[str]) -> dict[str, float]:
    """Mean seconds of each method for one of `parts`."""
    seconds_by_method = defaultdict(list)
    for row in read_csv(folder / "cost.csv"):
        if row["stage"] == "reconstruct" and row["part_id"] in parts:
            seconds_by_method[row["method"]].append(float(row["seconds"]))
    return {method: fmean(seconds) for method, seconds in seconds_by_method.items()}


def _table1(folder: Path) -> str:
    interval = _interval_label(folder)
    seconds = _mean_seconds(folder, {row["part_id"] for row in _scores(folder)})
    columns = ["inputs", "EMD (even)", interval, "EMD, mm", "x floor", "failed"]
    cells_by_method = table1_cells(folder)
    table_rows = [
        [
            row["method"] + (" (undertrained)" if row["undertrained"] else ""),
            *map(cells_by_method[row["method"]].get, columns),
            format_fixed(seconds.get(row["method"]), 1),
            format_fixed(float(row["paper_emd"])) if row["paper_emd"] else "",
        ]
        for row in read_csv(folder / "table1.csv")
        if row["split"] == "test"
    ]
    heads = [head.replace("EMD, mm", "mm") for head in columns]
    return markdown_table(["method", *heads, "s a part", "paper"], table_rows)


def table1_cells(folder: Path) -> dict[str, CsvRow]:
    """Method -> what Table 1 says of it to people: to round its CSV again may say another digit."""
    rows = read_markdown_table(folder / "table1.md")
    return {row["method"]: row for row in rows if row["split"] == "test"}


def _table2(rows: list[CsvRow]) -> str:
    """A line a method and loss, a column a subset; empty if no method renders."""
    if not rows:
        return ""
    values = {(*_method_and_loss(row), row["subset"]): row["value"] for row in rows}
    table_rows = [
        [
            *key,
            *(format_csv_number(values.get((*key, name))) for name in ("all", "figure3")),
            format_csv_number(paper_value),
        ]
        for key, paper_value in {_method_and_loss(row): row["paper"] for row in rows}.items()
    ]
    return "\n" + markdown_table(
        ["method", "loss", "all test parts", "one a family", "paper"], table_rows
    )


def _method_and_loss(row: CsvRow) -> tuple[str, str]:
    """The method, and the loss in words; in mm with its unit."""
    name = next(loss.name for loss in LOSSES if loss.metric == row["loss"])
    return row["method"], name + {"mm": ", mm", "mm^2": ", mm²"}.get(row["unit"], "")
