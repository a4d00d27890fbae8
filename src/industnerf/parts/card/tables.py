"""The tables of the data card, in Markdown."""

from collections import Counter
from collections.abc import Sequence

import numpy as np

from industnerf.artifacts.split import Place
from industnerf.parts.catalogue import Entry
from industnerf.parts.checks import MOST_BACK_FACES, VOLUME_WITHIN
from industnerf.parts.strata import FORMULAS


def percent(share: float, decimals: int = 1) -> str:
    return f"{100 * share:.{decimals}f} %"


def table(heads: str, rows: Sequence[Sequence[object]]) -> str:
    """A Markdown table; a head that ends in ":" is one of a column of numbers."""
    names = heads.split(" | ")
    rules = ["--:" if name.endswith(":") else "---" for name in names]
    lines = [[name.removesuffix(":") for name in names], rules, *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def checks_table(entries: Sequence[Entry]) -> str:
    """How many parts pass each check, and the worst."""
    by_volume = min(entries, key=lambda entry: entry.measured.volume_mm3 or -np.inf)
    by_back = max(entries, key=lambda entry: entry.back_face_share)
    closed = [entry for entry in entries if entry.measured.volume_mm3 is not None]
    rows = [
        ("closed, consistently oriented", _of(len(closed), entries), ""),
        (
            "positive volume",
            _of(sum((entry.measured.volume_mm3 or 0) > 0 for entry in entries), entries),
            f"{(by_volume.measured.volume_mm3 or 0) / 1000:.3g} cm³, `{by_volume.id}`",
        ),
        (
            f"back faces met by less than {percent(MOST_BACK_FACES)} of the rays from outside",
            _of(sum(entry.back_face_share < MOST_BACK_FACES for entry in entries), entries),
            f"{percent(by_back.back_face_share, 4)}, `{by_back.id}`",
        ),
    ]
    for reference, name in (
        ("b-rep", "the exact B-rep"),
        ("finer mesh", "a mesh four times finer"),
    ):
        held = [entry for entry in closed if entry.reference == reference]
        within = sum(abs(entry.volume_deviation) <= VOLUME_WITHIN for entry in held)
        worst = max(held, key=lambda entry: abs(entry.volume_deviation), default=None)
        said = f"{percent(worst.volume_deviation, 2)}, `{worst.id}`" if worst else ""
        rows.append((f"volume within {percent(VOLUME_WITHIN)} of {name}", _of(within, held), said))
    return table("check | parts | worst", rows)


def _of(count: int, entries: Sequence[Entry]) -> str:
    return f"{count} of {len(entries)}"


def strata_table(entries: Sequence[Entry], places: dict[str, Place]) -> str:
    """The strata, their formulas, and how many parts are in each."""
    rows = []
    for name, formula in FORMULAS.items():
        members = [entry for entry in entries if name in entry.measured.strata]
        dev = sum(places[entry.id].split == "dev" for entry in members)
        rows.append((name, formula, len(members), dev))
    return table("stratum | formula | parts: | of them dev:", rows)


def family_table(entries: Sequence[Entry], places: dict[str, Place]) -> str:
    """The families: how many parts, how many of them dev, and the fold of the others."""
    rows = []
    for family, count in Counter(entry.family for entry in entries).items():
        placed = [places[entry.id] for entry in entries if entry.family == family]
        folds = {str(place.fold) for place in placed if place.fold is not None}
        dev = sum(place.split == "dev" for place in placed)
        rows.append((family, count, dev, ", ".join(sorted(folds))))
    return table("family | parts: | of them dev: | fold:", rows)


def part_tables(entries: Sequence[Entry]) -> str:
    """A table of parts for every family."""
    heads = "part | designation | size, mm | volume, cm³: | faces: | bodies: | holes: "
    heads += "| seen: | hull-hidden: | strata"
    blocks = []
    for family in dict.fromkeys(entry.family for entry in entries):
        rows = [_row(entry) for entry in entries if entry.family == family]
        blocks.append(f"### {family}\n\n{table(heads, rows)}\n")
    return "\n".join(blocks)


def _row(entry: Entry) -> tuple[str, ...]:
    facts = entry.measured
    return (
        f"`{entry.id}`",
        entry.designation,
        " x ".join(f"{side:.4g}" for side in facts.extents_mm),
        f"{(facts.volume_mm3 or 0) / 1000:.3g}",
        str(facts.faces),
        str(facts.bodies),
        str(facts.through_holes),
        percent(facts.visible_share),
        percent(facts.hull_hidden_share),
        ", ".join(facts.strata),
    )
