"""Fixed subsets of the parts, chosen by hash: no result can move them.

figure3    One test part of every family, the one whose hash is smallest. The paper's section
           4.6.2 scores what its Figure 3 shows, and does not say which parts that is or how they
           were chosen.
viewer     What the contact sheet and the page's viewer show: figure3, then others.
seeds      The SEED_PARTS test parts whose hashes are smallest (conf/experiment/twenty.yaml).
"""

from collections.abc import Iterable

from industnerf.artifacts.part import Part
from industnerf.report.study import Study
from industnerf.seeds import seed_for

SEED_PARTS = 20


def figure3_parts(study: Study) -> set[str]:
    """The part ids of the subset `figure3`."""
    test_ids = [name for name in study.parts if study.assignments[name].split == "test"]
    by_family: dict[str, str] = {}
    for name in order_by_hash("figure3", test_ids):
        by_family.setdefault(study.parts[name].family, name)
    return set(by_family.values())


def select_viewer_parts(study: Study, count: int) -> list[Part]:
    """Up to `count` parts that have views and a truth, by family: `figure3` and then others."""
    drawable = [
        name
        for name in study.parts
        if (study.folders.views / name).is_dir() and (study.folders.truth / name).is_dir()
    ]
    figure3_ids = figure3_parts(study)
    ordered = sorted(order_by_hash("figure3", drawable), key=lambda name: name not in figure3_ids)
    parts = [study.parts[name] for name in ordered[:count]]
    return sorted(parts, key=lambda part: (part.family, part.part_id))


def seed_parts(part_ids: Iterable[str]) -> set[str]:
    """The subset `seeds` of the test parts `part_ids`."""
    return set(order_by_hash("seeds", part_ids)[:SEED_PARTS])


def order_by_hash(purpose: str, part_ids: Iterable[str]) -> list[str]:
    """`part_ids` in an order that depends on them and `purpose` alone, not on the study's seed."""
    return sorted(part_ids, key=lambda name: (seed_for(0, purpose, name), name))
