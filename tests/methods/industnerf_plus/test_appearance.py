"""What is said of a surface that is the true one: colors agree on all of it."""

import numpy as np

from industnerf.methods.industnerf_plus.appearance import HALVING_DEPTH, Appearance
from industnerf.methods.industnerf_plus.shaded_surface import PinholeRays

from .plugged_block import BLOCK, DEPTH, POCKET, SIZE, TOP, VIEWS, photographs, surface_of


def test_the_floor_of_a_pocket_is_less_sure_than_the_face_that_it_opens_in():
    """Of both colors agree; only silhouettes tell them apart."""
    pocket = np.maximum(BLOCK, -POCKET)
    surface = surface_of(pocket)
    rays = PinholeRays(VIEWS, np.zeros(3), 1.0, surface.grid)
    appearance = Appearance(surface, rays, photographs(pocket))
    middle = (SIZE - 1) / 2
    spread = np.linspace(-2, 2, 5)
    x, y = (axis.ravel() + middle for axis in np.meshgrid(spread, spread))
    on_face = np.column_stack([x - 12, y, np.full(25, middle + TOP)])
    on_floor = np.column_stack([x + 1, y, np.full(25, middle + TOP - DEPTH)])
    face, floor = (appearance.confidence(points) for points in (on_face, on_floor))
    assert (face > 0.95).all()
    np.testing.assert_allclose(floor, 1 / (1 + DEPTH / HALVING_DEPTH), rtol=0.05)
