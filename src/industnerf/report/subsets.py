"""Fixed choices among parts, by hash: nobody picked them, and no result can move them.

figure3    One test part of every family, the one whose hash is smallest.  The paper's section
           4.6.2 scores what its Figure 3 shows, and does not say which parts that is nor how they
           were chosen.  A figure shows a part of each kind, so ours does, whatever it looks like.
exhibited  What the contact sheet and the page's viewer show: figure3, then others.
seeds      The SEED_PARTS test parts whose hashes are smallest (conf/experiment/twenty.yaml).
"""

from collections.abc import Iterable

from industnerf.artifacts.part import Part
from industnerf.report.gather import Study
from industnerf.seeds import seed_for

SEED_PARTS = 20


def figure3(study: Study) -> set[str]:
    """The part ids of the subset `figure3`."""
    tested = [name for name in study.parts if study.places[name].split == "test"]
    chosen: dict[str, str] = {}
    for name in by_hash("figure3", tested):
        chosen.setdefault(study.parts[name].family, name)
    return set(chosen.values())


def exhibited(study: Study, count: int) -> list[Part]:
    """Up to `count` parts that have views and a truth, by family: `figure3` and then others."""
    ready = [
        name
        for name in study.parts
        if (study.folders.views / name).is_dir() and (study.folders.truth / name).is_dir()
    ]
    shown = figure3(study)
    first = sorted(by_hash("figure3", ready), key=lambda name: name not in shown)[:count]
    parts = [study.parts[name] for name in first]
    return sorted(parts, key=lambda part: (part.family, part.part_id))


def seed_parts(tested: Iterable[str]) -> set[str]:
    """The subset `seeds` of the test parts `tested`."""
    return set(by_hash("seeds", tested)[:SEED_PARTS])


def by_hash(purpose: str, part_ids: Iterable[str]) -> list[str]:
    """`part_ids` in an order that depends on them and `purpose` alone, not on the study's seed."""
    return sorted(part_ids, key=lambda name: (seed_for(0, purpose, name), name))
