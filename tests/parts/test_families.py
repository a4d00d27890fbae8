"""The drawings still give the baked parts: one of each family, drawn anew."""

import warnings

import pytest

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # the CAD libraries' own
    pytest.importorskip("build123d")
    pytest.importorskip("manifold3d")
    from industnerf.parts.bake import bake
    from industnerf.parts.families import FAMILIES

from industnerf.errors import BadPart
from industnerf.parts.catalogue import catalogue

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::UserWarning"),
]

ENTRIES = {entry.id: entry for entry in catalogue()}
RECIPES = [(family, recipe) for family, recipes in FAMILIES.items() for recipe in recipes]


def test_catalogue_and_families_name_the_same_parts():
    assert sorted(recipe.id for _, recipe in RECIPES) == sorted(ENTRIES)
    for family, recipe in RECIPES:
        entry = ENTRIES[recipe.id]
        assert (entry.family, entry.designation) == (family, recipe.designation)
        assert (entry.library, entry.parameters) == (recipe.library, recipe.parameters)


@pytest.mark.parametrize("family", FAMILIES)
def test_a_part_drawn_anew_is_the_part_that_was_baked(family):
    """Not byte by byte: another version of the CAD kernel may triangulate otherwise."""
    recipe = FAMILIES[family][0]
    fresh, stored = bake(family, recipe).entry, ENTRIES[recipe.id]
    # Two tessellations of one solid differ at most by their own error, 0.5 % of the volume.
    assert fresh.volume_mm3 == pytest.approx(stored.volume_mm3, rel=5e-3)
    # ... and by the chord error in their box, 5e-4 of its diagonal.
    diagonal = sum(side**2 for side in stored.extents_mm) ** 0.5
    assert fresh.extents_mm == pytest.approx(stored.extents_mm, rel=0, abs=1e-3 * diagonal)
    assert fresh.bodies == stored.bodies
    if stored.brep_volume_mm3 is not None:
        assert fresh.brep_volume_mm3 == pytest.approx(stored.brep_volume_mm3, rel=1e-6)


def test_an_empty_drawing_is_refused():
    from build123d import Cylinder

    from industnerf.parts.tessellate import tessellate

    with pytest.raises(BadPart, match="no solid"):
        tessellate(Cylinder(1, 1) - Cylinder(2, 2))
