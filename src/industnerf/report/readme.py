"""Tables for the README, made of what is published: only the columns that a reader needs there."""

from collections import defaultdict
from collections.abc import Set
from itertools import accumulate
from pathlib import Path
from statistics import fmean

from industnerf.config import flat, read_yaml
from industnerf.report.formats import csv_rows, markdown, markdown_rows, rounded, short
from industnerf.report.provenance import made_where, read_made
from industnerf.report.table2 import LOSSES
from industnerf.report.words import in_words

Cells = dict[str, str]


def study_block(folder: Path, params: Path) -> str:
    """Tables 1 and 2 of the study published in `folder`, what it found, and where it comes from.

    `params` is params.yaml as it is now: what has changed in it since is named.
    """
    return (
        f"{_of_what(folder)}{_table1(folder)}"
        f"{_table2(csv_rows(folder / 'table2.csv'))}"
        f"{_found(folder)}"
        f"{_since(folder / 'params.yaml', params)}"
    )


def demo_block(folder: Path) -> str:
    """Table 1 of the demo published in `folder`, and where it comes from."""
    return f"{_of_what(folder)}{_table1(folder)}"


def _of_what(folder: Path) -> str:
    scores = _scores(folder)
    parts, families = (len({row[name] for row in scores}) for name in ("part_id", "family"))
    where = f"results/{folder.name}"
    return (
        f"{parts} test parts of {families} families, {made_where(folder)}; every number "
        f"is in [{where}]({where}).\n\n"
    )


def _scores(folder: Path) -> list[Cells]:
    return [row for row in csv_rows(folder / "scores.csv") if row["split"] == "test"]


def _interval(folder: Path) -> str:
    """How sure the intervals are."""
    return f"{100 * read_made(folder)['interval']:g} %"


def _found(folder: Path) -> str:
    words = in_words(folder, _interval(folder))
    return f"\n{words}" if words else ""


def _since(then: Path, now: Path) -> str:
    """A sentence on what of params.yaml is no longer as the study had it, or nothing."""
    old, new = (flat(read_yaml(path)) for path in (then, now))
    changed = {key for key in old.keys() & new.keys() if old[key] != new[key]}
    found = {
        "has changed in": {".".join(key.split(".")[:3]) for key in changed},
        "has gained": _only_in(new.keys(), old.keys()),
        "has lost": _only_in(old.keys(), new.keys()),
    }
    said = [f"{words} {_named(keys)}" for words, keys in found.items() if keys]
    return f"\nSince then params.yaml {' and '.join(said)}.\n" if said else ""


def _only_in(these: Set[str], those: Set[str]) -> set[str]:
    """Keys of `these` that are not in `those`: where a whole section is not, the section."""
    known = {section for key in those for section in _sections(key)}
    return {next((s for s in _sections(key) if s not in known), key) for key in these - those}


def _sections(key: str) -> list[str]:
    """What `key` is in, from the widest to itself: a, a.b, a.b.c."""
    return list(accumulate(key.split("."), "{}.{}".format))


def _named(keys: Set[str]) -> str:
    return ", ".join(f"`{key}`" for key in sorted(keys))


def _seconds(folder: Path, parts: set[str]) -> dict[str, float]:
    """Mean seconds of each method for one of `parts`."""
    found = defaultdict(list)
    for row in csv_rows(folder / "cost.csv"):
        if row["stage"] == "reconstruct" and row["part_id"] in parts:
            found[row["method"]].append(float(row["seconds"]))
    return {method: fmean(seconds) for method, seconds in found.items()}


def _table1(folder: Path) -> str:
    interval = _interval(folder)
    seconds = _seconds(folder, {row["part_id"] for row in _scores(folder)})
    taken = ["inputs", "EMD (even)", interval, "EMD, mm", "x floor", "failed"]
    texts = table1_texts(folder)
    lines = [
        [
            row["method"] + (" (undertrained)" if row["undertrained"] else ""),
            *map(texts[row["method"]].get, taken),
            short(seconds.get(row["method"]), 1),
            short(float(row["paper_emd"])) if row["paper_emd"] else "",
        ]
        for row in csv_rows(folder / "table1.csv")
        if row["split"] == "test"
    ]
    heads = [head.replace("EMD, mm", "mm") for head in taken]
    return markdown(["method", *heads, "s a part", "paper"], lines)


def table1_texts(folder: Path) -> dict[str, Cells]:
    """Method -> what Table 1 says of it to people: to round its CSV again may say another digit."""
    rows = markdown_rows(folder / "table1.md")
    return {row["method"]: row for row in rows if row["split"] == "test"}


def _table2(rows: list[Cells]) -> str:
    """A line a method and loss, a column a subset; empty if no method renders."""
    if not rows:
        return ""
    values = {(*_loss(row), row["subset"]): row["value"] for row in rows}
    lines = [
        [*key, *(rounded(values.get((*key, name))) for name in ("all", "figure3")), rounded(paper)]
        for key, paper in {_loss(row): row["paper"] for row in rows}.items()
    ]
    return "\n" + markdown(["method", "loss", "all test parts", "one a family", "paper"], lines)


def _loss(row: Cells) -> tuple[str, str]:
    """The method, and the loss in words; in mm with its unit."""
    name = next(loss.name for loss in LOSSES if loss.metric == row["loss"])
    return row["method"], name + {"mm": ", mm", "mm^2": ", mm²"}.get(row["unit"], "")
