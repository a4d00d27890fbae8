"""The published spread over seeds stands beside the methods that it is of, and no others."""

import pytest

from industnerf.report.part_subsets import SEED_PARTS, order_by_hash
from industnerf.report.statistics.seed_variance import add_seed_variance, seed_variance, seeds_csv
from tests.samples import unit_part
from tests.studies import make_study

NAMES = order_by_hash("seeds", [f"part-{i}" for i in range(SEED_PARTS + 5)])
EMDS = [0.01 + 0.001 * i for i in range(len(NAMES))]


@pytest.fixture
def seeds(tmp_path):
    """A sweep over two seeds, of two methods, on the fixed parts; with seed 1 all EMDs are more."""
    fixed = {
        seed: {
            name: emd + 0.002 * seed for name, emd in zip(NAMES[:SEED_PARTS], EMDS, strict=False)
        }
        for seed in (0, 1)
    }
    (tmp_path / "seeds.csv").write_text(
        seeds_csv([seed_variance(name, fixed) for name in ("hull", "box")])
    )
    return tmp_path


def methods_with_variance(seeds, emds, names=NAMES, preset="study", **changes):
    study = make_study([unit_part(name) for name in names], emds, preset=preset, **changes)
    return set(add_seed_variance(study, seeds).seeds_sd)


def test_it_stands_beside_a_method_that_has_these_emds(seeds):
    """Whatever the preset is called, and of which other parts there are."""
    assert methods_with_variance(seeds, {"hull": EMDS, "box": EMDS}, preset="mine") == {
        "hull",
        "box",
    }
    some = NAMES[:SEED_PARTS]
    assert methods_with_variance(seeds, {"hull": EMDS[:SEED_PARTS]}, some) == {"hull"}


def test_a_method_whose_settings_were_changed_has_none(seeds):
    """In the sixth digit it is the same, for more seeds.csv does not have."""
    changed = [1.0001 * emd for emd in EMDS]
    assert methods_with_variance(
        seeds, {"hull": changed, "box": [1.000001 * emd for emd in EMDS]}
    ) == {"box"}


def test_other_parts_have_none(seeds):
    """One is missing, and the mean the same; all are others; those of the sweep are dev parts."""
    first, mean = EMDS[: SEED_PARTS - 2], sum(EMDS[:SEED_PARTS]) / SEED_PARTS
    few = [*first, (SEED_PARTS - 1) * mean - sum(first)]
    assert methods_with_variance(seeds, {"hull": few}, NAMES[: SEED_PARTS - 1]) == set()
    fixed = NAMES[:SEED_PARTS]
    assert methods_with_variance(seeds, {"hull": EMDS}, [f"my-{name}" for name in NAMES]) == set()
    assert methods_with_variance(seeds, {"hull": EMDS}, dev=fixed) == set()


def test_a_seed_stands_beside_its_own_mean(seeds):
    assert methods_with_variance(seeds, {"hull": EMDS}, seed=1) == set()
    assert methods_with_variance(seeds, {"hull": [emd + 0.002 for emd in EMDS]}, seed=1) == {"hull"}
    assert methods_with_variance(seeds, {"hull": EMDS}, seed=2) == set()


def test_without_a_spread_there_is_none(tmp_path):
    assert methods_with_variance(tmp_path, {"hull": EMDS}) == set()
