"""Beams that cover a mesh from all round."""

import numpy as np
import pytest

from industnerf.geometry.ray_bundles import parallel_ray_bundles

LOW, HIGH = np.array([1.0, 2.0, 3.0]), np.array([4.0, 9.0, 5.0])  # mm
CORNERS = np.array([[x, y, z] for x in (1, 4) for y in (2, 9) for z in (3, 5)], dtype=np.float64)


def test_every_beam_starts_outside_and_covers_the_box():
    reach = np.linalg.norm(HIGH - LOW) / 2
    directions = []
    for origins, direction in parallel_ray_bundles(CORNERS, 20, 8):
        directions.append(direction)
        assert np.linalg.norm(direction) == pytest.approx(1)
        # All start on one plane, two reaches before the middle: no corner is so far from it.
        assert (origins - (LOW + HIGH) / 2) @ direction == pytest.approx(-2 * reach)
        # Every corner's ray of the beam passes within half a cell's diagonal of one in the grid.
        across = CORNERS - (CORNERS - origins[0]) @ direction[:, None] * direction
        gap = np.linalg.norm(origins[None] - across[:, None], axis=-1).min(axis=1)
        assert gap.max() <= reach / 8 * np.sqrt(2) + 1e-12
    assert np.linalg.norm(np.mean(directions, axis=0)) < 0.05  # from all round


def test_neighboring_rays_are_a_cell_apart():
    origins, _ = next(parallel_ray_bundles(CORNERS, 1, 8))
    grid = origins.reshape(8, 8, 3)
    cell = np.linalg.norm(HIGH - LOW) / 8
    for steps in (np.diff(grid, axis=0), np.diff(grid, axis=1)):
        np.testing.assert_allclose(np.linalg.norm(steps, axis=-1), cell, rtol=1e-12)
