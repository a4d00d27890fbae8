"""The data card: docs/reference/dataset.md and its contact sheets, all from the catalogues."""

from collections import Counter
from pathlib import Path

import numpy as np

from industnerf.artifacts.split import SplitAssignment
from industnerf.config import load_params
from industnerf.parts.catalogue.data_card.tables import (
    checks_table,
    family_table,
    part_tables,
    percent,
    strata_table,
)
from industnerf.parts.catalogue.data_card.text import CARD_TEMPLATE, ORGANIC_TEMPLATE
from industnerf.parts.catalogue.entries import load_catalogue_mesh, read_catalogue, to_part
from industnerf.parts.contact_sheet import render_tile, write_contact_sheet, write_gallery
from industnerf.parts.split import assign_splits

COLUMNS = 8  # of a contact sheet
GALLERY = 13, 110  # columns and px of the README's picture


def write_card(root: Path) -> list[Path]:
    """Write the card of the repository at `root` and its sheets; returns what was written."""
    embedded, organic = root / "data/embedded", root / "data/organic"
    document, sheets = root / "docs/reference/dataset.md", root / "docs/reference"
    gallery = root / "docs/parts.png"
    settings = load_params(root / "params.yaml").split
    splits = assign_splits([to_part(entry) for entry in read_catalogue(embedded)], settings)
    document.write_text(render_card(embedded, organic, splits), encoding="utf-8")
    write_sheet(embedded, sheets / "dataset.png")
    parts = [
        (load_catalogue_mesh(entry, embedded), entry.finishes) for entry in read_catalogue(embedded)
    ]
    write_gallery(parts, gallery, *GALLERY)
    if not organic.exists():
        return [document, sheets / "dataset.png", gallery]
    write_sheet(organic, sheets / "organic.png")
    return [document, sheets / "dataset.png", gallery, sheets / "organic.png"]


def render_card(folder: Path, organic: Path, splits: dict[str, SplitAssignment]) -> str:
    """The text of docs/reference/dataset.md.

    `folder` is the embedded set, `organic` the non-industrial one, which may be missing, and
    `splits` has the split of every embedded part.
    """
    entries = read_catalogue(folder)
    properties = [entry.measured for entry in entries]
    text = CARD_TEMPLATE.format(
        parts=len(entries),
        families=len({entry.family for entry in entries}),
        megabytes=_megabytes(folder),
        triangles=sum(measured.faces for measured in properties) / 1e6,
        median_faces=int(np.median([measured.faces for measured in properties])),
        most_faces=max(measured.faces for measured in properties),
        libraries=_format_counts(Counter(entry.library for entry in entries)),
        colored=sum(len(entry.finishes) > 1 for entry in entries),
        finishes=len({finish.name for entry in entries for finish in entry.finishes}),
        like=sum("-like" in entry.designation for entry in entries),
        seen_less=sum(measured.visible_share < 0.9 for measured in properties),
        median_hidden=percent(
            float(np.median([measured.hull_hidden_share for measured in properties]))
        ),
        most_hidden=percent(max(measured.hull_hidden_share for measured in properties)),
        checks=checks_table(entries),
        strata=strata_table(entries, splits),
        family_table=family_table(entries, splits),
        dev=", ".join(
            f"`{split_entry.id}`"
            for split_entry in entries
            if splits[split_entry.id].split == "dev"
        ),
        part_tables=part_tables(entries),
    )
    if not (organic / "catalogue.json").exists():
        return text
    organic_entries = read_catalogue(organic)
    return text + ORGANIC_TEMPLATE.format(
        parts=len(organic_entries),
        megabytes=_megabytes(organic),
        part_tables=part_tables(organic_entries),
    )


def _megabytes(folder: Path) -> float:
    return sum(path.stat().st_size for path in folder.glob("*.npz")) / 1e6


def _format_counts(counts: Counter[str]) -> str:
    return ", ".join(f"{name} {count}" for name, count in counts.most_common())


def write_sheet(folder: Path, path: Path) -> None:
    """Write the contact sheet of the set in `folder`."""
    tiles = [
        render_tile(
            f"{entry.id}\n{entry.designation}", load_catalogue_mesh(entry, folder), entry.finishes
        )
        for entry in read_catalogue(folder)
    ]
    write_contact_sheet(tiles, path, COLUMNS)
