"""Meshes of patches against squares whose area is known."""

import numpy as np
import pytest

from industnerf.methods.atlasnet.patches import grid, sample_patches


@pytest.mark.parametrize("side", [2, 5])
def test_a_grid_covers_the_unit_square_once(side):
    uv, faces = grid(side)
    assert sorted(map(tuple, uv)) == [
        (i / (side - 1), j / (side - 1)) for i in range(side) for j in range(side)
    ]
    along = uv[faces][:, 1:] - uv[faces][:, :1]
    areas = np.linalg.det(along) / 2
    # all triangles have one area, and one way round: together 1
    np.testing.assert_allclose(areas, 1 / (2 * (side - 1) ** 2), rtol=1e-12)
    assert len(faces) == 2 * (side - 1) ** 2


def plates(*sizes_and_heights, side=5):
    """Squares of edges (x, y) from the origin, level, at heights z."""
    uv, faces = grid(side)
    flat = [np.c_[uv * size, np.full(len(uv), z)] for size, z in sizes_and_heights]
    return np.stack(flat), faces


def test_patches_have_points_by_their_area():
    points = sample_patches(*plates(((1, 1), 0.0), ((3, 1), 1.0)), 20000, np.random.default_rng(0))
    # 4 standard deviations of 20 000 draws are 1.2 %
    assert (points[:, 2] == 1).mean() == pytest.approx(0.75, abs=0.013)


def test_points_are_even_over_a_patch():
    points = sample_patches(*plates(((3, 1), 0.0)), 40000, np.random.default_rng(0))
    counts, _, _ = np.histogram2d(*points[:, :2].T, bins=(6, 2), range=[(0, 3), (0, 1)])
    # 12 bins of 3333 draws, each +- 55: within 5 of these
    assert np.abs(counts - 40000 / 12).max() < 275
    assert not points[:, 2].any()
