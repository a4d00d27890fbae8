"""The tables of the data card, in Markdown."""

from collections import Counter
from collections.abc import Sequence

import numpy as np

from industnerf.artifacts.split import SplitAssignment
from industnerf.parts.catalogue.entries import CatalogueEntry
from industnerf.parts.strata import STRATUM_DEFINITIONS
from industnerf.parts.validation.checks import MAX_BACK_FACE_SHARE, VOLUME_TOLERANCE


def percent(share: float, decimals: int = 1) -> str:
    return f"{100 * share:.{decimals}f} %"


def markdown_table(header: str, rows: Sequence[Sequence[object]]) -> str:
    """A Markdown table; a head that ends in ":" is one of a column of numbers."""
    titles = header.split(" | ")
    separators = ["--:" if title.endswith(":") else "---" for title in titles]
    all_rows = [[title.removesuffix(":") for title in titles], separators, *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in row) + " |" for row in all_rows)


def checks_table(entries: Sequence[CatalogueEntry]) -> str:
    """How many parts pass each check, and the worst."""
    smallest_volume = min(entries, key=lambda entry: entry.measured.volume_mm3 or -np.inf)
    worst_back_faces = max(entries, key=lambda entry: entry.back_face_share)
    closed = [entry for entry in entries if entry.measured.volume_mm3 is not None]
    rows = [
        ("closed, consistently oriented", _count_of(len(closed), entries), ""),
        (
            "positive volume",
            _count_of(sum((entry.measured.volume_mm3 or 0) > 0 for entry in entries), entries),
            f"{(smallest_volume.measured.volume_mm3 or 0) / 1000:.3g} cm³, `{smallest_volume.id}`",
        ),
        (
            f"back faces met by less than {percent(MAX_BACK_FACE_SHARE)} of the rays from outside",
            _count_of(
                sum(entry.back_face_share < MAX_BACK_FACE_SHARE for entry in entries), entries
            ),
            f"{percent(worst_back_faces.back_face_share, 4)}, `{worst_back_faces.id}`",
        ),
    ]
    for reference, name in (
        ("b-rep", "the exact B-rep"),
        ("finer mesh", "a mesh four times finer"),
    ):
        matching = [entry for entry in closed if entry.reference == reference]
        num_within = sum(abs(entry.volume_deviation) <= VOLUME_TOLERANCE for entry in matching)
        worst = max(matching, key=lambda entry: abs(entry.volume_deviation), default=None)
        worst_text = f"{percent(worst.volume_deviation, 2)}, `{worst.id}`" if worst else ""
        rows.append(
            (
                f"volume within {percent(VOLUME_TOLERANCE)} of {name}",
                _count_of(num_within, matching),
                worst_text,
            )
        )
    return markdown_table("check | parts | worst", rows)


def _count_of(count: int, entries: Sequence[CatalogueEntry]) -> str:
    return f"{count} of {len(entries)}"


def strata_table(entries: Sequence[CatalogueEntry], splits: dict[str, SplitAssignment]) -> str:
    """The strata, their formulas, and how many parts are in each."""
    rows = []
    for name, formula in STRATUM_DEFINITIONS.items():
        members = [entry for entry in entries if name in entry.measured.strata]
        dev = sum(splits[entry.id].split == "dev" for entry in members)
        rows.append((name, formula, len(members), dev))
    return markdown_table("stratum | formula | parts: | of them dev:", rows)


def family_table(entries: Sequence[CatalogueEntry], splits: dict[str, SplitAssignment]) -> str:
    """The families: how many parts, how many of them dev, and the fold of the others."""
    rows = []
    for family, count in Counter(entry.family for entry in entries).items():
        family_splits = [splits[entry.id] for entry in entries if entry.family == family]
        folds = {
            str(assignment.fold) for assignment in family_splits if assignment.fold is not None
        }
        dev = sum(assignment.split == "dev" for assignment in family_splits)
        rows.append((family, count, dev, ", ".join(sorted(folds))))
    return markdown_table("family | parts: | of them dev: | fold:", rows)


def part_tables(entries: Sequence[CatalogueEntry]) -> str:
    """A table of parts for every family."""
    header = "part | designation | size, mm | volume, cm³: | faces: | bodies: | holes: "
    header += "| seen: | hull-hidden: | strata"
    blocks = []
    for family in dict.fromkeys(entry.family for entry in entries):
        rows = [_part_row(entry) for entry in entries if entry.family == family]
        blocks.append(f"### {family}\n\n{markdown_table(header, rows)}\n")
    return "\n".join(blocks)


def _part_row(entry: CatalogueEntry) -> tuple[str, ...]:
    properties = entry.measured
    return (
        f"`{entry.id}`",
        entry.designation,
        " x ".join(f"{side:.4g}" for side in properties.extents_mm),
        f"{(properties.volume_mm3 or 0) / 1000:.3g}",
        str(properties.faces),
        str(properties.bodies),
        str(properties.through_holes),
        percent(properties.visible_share),
        percent(properties.hull_hidden_share),
        ", ".join(properties.strata),
    )
