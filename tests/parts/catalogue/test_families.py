"""The drawings still give the baked parts: some of each family, drawn anew."""

import hashlib
import warnings

import numpy as np
import pytest

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # the CAD libraries' own
    pytest.importorskip("build123d")
    from industnerf.parts.catalogue.families import FAMILIES
    from industnerf.parts.catalogue.part_builder import build_part

from industnerf.errors import BadPart
from industnerf.parts.catalogue.entries import read_catalogue
from industnerf.parts.catalogue.recipe import Recipe
from industnerf.parts.validation.checks import MAX_BACK_FACE_SHARE, VOLUME_TOLERANCE

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::UserWarning"),
]

ENTRIES = {entry.id: entry for entry in read_catalogue()}
RECIPES = [(family, recipe) for family, recipes in FAMILIES.items() for recipe in recipes]
RECIPES_PER_FAMILY = 2


def sampled_recipes() -> list[tuple[str, Recipe]]:
    """A few recipes of each family, by hash: the same in every run, and nobody's choice."""

    def hash_key(recipe: Recipe) -> str:
        return hashlib.sha256(f"drawn anew/{recipe.id}".encode()).hexdigest()

    return [
        (family, recipe)
        for family, recipes in FAMILIES.items()
        for recipe in sorted(recipes, key=hash_key)[:RECIPES_PER_FAMILY]
    ]


def test_catalogue_and_families_name_the_same_parts():
    assert sorted(recipe.id for _, recipe in RECIPES) == sorted(ENTRIES)
    for family, recipe in RECIPES:
        entry = ENTRIES[recipe.id]
        assert (entry.family, entry.designation) == (family, recipe.designation)
        assert (entry.library, entry.parameters) == (recipe.library, recipe.parameters)


@pytest.mark.parametrize(("family", "recipe"), sampled_recipes(), ids=lambda x: getattr(x, "id", x))
def test_a_rebuilt_part_is_the_stored_part(family, recipe):
    """Not byte by byte: another version of the CAD kernel may triangulate otherwise."""
    fresh, stored = build_part(family, recipe).entry, ENTRIES[recipe.id]
    now, then = fresh.measured, stored.measured
    # Each mesh is off the same volume by the recipe's tolerance at most.
    assert now.volume_mm3 == pytest.approx(then.volume_mm3, rel=2 * VOLUME_TOLERANCE)
    # Boxes differ by the chord error of either, 5e-4 of the diagonal.
    diagonal = float(np.linalg.norm(then.extents_mm))
    assert now.extents_mm == pytest.approx(then.extents_mm, rel=0, abs=1e-3 * diagonal)
    # Closed and oriented, or there would be no volume; no more or fewer pieces and holes.
    assert (now.bodies, now.euler_number) == (then.bodies, then.euler_number)
    assert fresh.back_face_share <= MAX_BACK_FACE_SHARE
    assert fresh.back_face_share == pytest.approx(stored.back_face_share, abs=MAX_BACK_FACE_SHARE)
    # Five standard errors of the difference between two shares of 4096 samples each, at worst
    # sqrt(2) * 0.8 %.
    assert now.visible_share == pytest.approx(then.visible_share, abs=0.055)
    assert now.hull_hidden_share == pytest.approx(then.hull_hidden_share, abs=0.055)
    assert (fresh.finishes, fresh.reference) == (stored.finishes, stored.reference)
    if fresh.reference == "b-rep":
        exact = stored.reference_volume_mm3
        assert fresh.reference_volume_mm3 == pytest.approx(exact, rel=1e-6)


def test_an_empty_drawing_is_refused():
    from build123d import Cylinder

    from industnerf.parts.catalogue.recipe import Assembly
    from industnerf.parts.catalogue.tessellate import tessellate

    with pytest.raises(BadPart, match="no solid"):
        tessellate(Assembly({"steel": Cylinder(1, 1) - Cylinder(2, 2)}))
