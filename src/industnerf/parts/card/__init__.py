"""The data card: docs/dataset.md and its contact sheets, all from the catalogues."""

from collections import Counter
from pathlib import Path

import numpy as np

from industnerf.artifacts.split import Place
from industnerf.config import load_params
from industnerf.parts.card.tables import (
    checks_table,
    family_table,
    part_tables,
    percent,
    strata_table,
)
from industnerf.parts.card.text import ORGANIC, TEXT
from industnerf.parts.catalogue import catalogue, load
from industnerf.parts.embedded import as_part
from industnerf.parts.sheet import contact_sheet, gallery, tile_of
from industnerf.parts.split import assign

COLUMNS = 8  # of a contact sheet
GALLERY = 13, 110  # columns and px of the README's picture


def write_card(root: Path) -> list[Path]:
    """Write the card of the repository at `root` and its sheets; returns what was written."""
    embedded, organic, docs = root / "data/embedded", root / "data/organic", root / "docs"
    settings = load_params(root / "params.yaml").split
    places = assign([as_part(entry) for entry in catalogue(embedded)], settings)
    (docs / "dataset.md").write_text(card(embedded, organic, places), encoding="utf-8")
    sheet(embedded, docs / "dataset.png")
    parts = [(load(entry, embedded), entry.finishes) for entry in catalogue(embedded)]
    gallery(parts, docs / "parts.png", *GALLERY)
    if not organic.exists():
        return [docs / "dataset.md", docs / "dataset.png", docs / "parts.png"]
    sheet(organic, docs / "organic.png")
    return [docs / name for name in ("dataset.md", "dataset.png", "parts.png", "organic.png")]


def card(folder: Path, organic: Path, places: dict[str, Place]) -> str:
    """The text of docs/dataset.md.

    `folder` is the embedded set, `organic` the non-industrial one, which may be missing, and
    `places` says of every embedded part where the split puts it.
    """
    entries = catalogue(folder)
    facts = [entry.measured for entry in entries]
    text = TEXT.format(
        parts=len(entries),
        families=len({entry.family for entry in entries}),
        megabytes=_megabytes(folder),
        triangles=sum(fact.faces for fact in facts) / 1e6,
        median_faces=int(np.median([fact.faces for fact in facts])),
        most_faces=max(fact.faces for fact in facts),
        libraries=_counted(Counter(entry.library for entry in entries)),
        coloured=sum(len(entry.finishes) > 1 for entry in entries),
        finishes=len({finish.name for entry in entries for finish in entry.finishes}),
        like=sum("-like" in entry.designation for entry in entries),
        seen_less=sum(fact.visible_share < 0.9 for fact in facts),
        median_hidden=percent(float(np.median([fact.hull_hidden_share for fact in facts]))),
        most_hidden=percent(max(fact.hull_hidden_share for fact in facts)),
        checks=checks_table(entries),
        strata=strata_table(entries, places),
        family_table=family_table(entries, places),
        dev=", ".join(f"`{e.id}`" for e in entries if places[e.id].split == "dev"),
        part_tables=part_tables(entries),
    )
    if not (organic / "catalogue.json").exists():
        return text
    others = catalogue(organic)
    return text + ORGANIC.format(
        parts=len(others), megabytes=_megabytes(organic), part_tables=part_tables(others)
    )


def _megabytes(folder: Path) -> float:
    return sum(path.stat().st_size for path in folder.glob("*.npz")) / 1e6


def _counted(counts: Counter[str]) -> str:
    return ", ".join(f"{name} {count}" for name, count in counts.most_common())


def sheet(folder: Path, path: Path) -> None:
    """Write the contact sheet of the set in `folder`."""
    tiles = [
        tile_of(f"{entry.id}\n{entry.designation}", load(entry, folder), entry.finishes)
        for entry in catalogue(folder)
    ]
    contact_sheet(tiles, path, COLUMNS)
