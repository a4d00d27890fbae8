"""What is found with few questions, against asking everywhere."""

import numpy as np
import pytest

from industnerf.geometry.isosurface import isosurface, volume_matched_level
from industnerf.methods.occupancy.mise import mise

CELLS, SUBDIVISIONS = 8, 2
SIZE = CELLS * 2**SUBDIVISIONS
LEVEL = 0.1


def at_level(values):
    """Whatever the values are."""
    return LEVEL


BALL = 1.5  # coarse cells: a ball of this radius has a coarse lattice point inside


def ball(center, radius):
    """Signed distance, in fine cells, high inside."""
    return lambda at: radius - np.linalg.norm(at - np.array(center), axis=-1)


def ring(at):
    across = np.hypot(*np.moveaxis(at[..., :2] - SIZE / 2, -1, 0)) - SIZE / 4
    return 3.0 - np.hypot(across, at[..., 2] - SIZE / 2)


def needle(at):
    """A ball, and a rod of a quarter of a coarse cell through it, between coarse lattice points."""
    x, y, z = np.moveaxis(at - [10.0, 10.0, 0.0], -1, 0)
    rod = np.minimum(1.1 - np.hypot(x, y), np.minimum(z - 2, 30 - z))
    return np.maximum(rod, ball((10, 10, 8), 5.5)(at))


def bubbles(seed):
    rng = np.random.default_rng(seed)
    some = [ball(rng.uniform(8, SIZE - 8, 3), rng.uniform(4 * BALL, 8)) for _ in range(3)]
    return lambda at: np.max([one(at) for one in some], axis=0)


SOLIDS = {
    "ball": ball((16.3, 15.2, 16.9), 9.4),
    "hollow": lambda at: np.minimum(ball((16, 16, 16), 13)(at), -ball((16, 16, 16), 8)(at)),
    "ring": ring,
    "needle": needle,
    "bubbles 1": bubbles(1),
    "bubbles 2": bubbles(2),
    "bubbles 3": bubbles(3),
}


class RecordingField:
    """A field that remembers where it was asked."""

    def __init__(self, field):
        self.field, self.at = field, []

    def __call__(self, at):
        self.at.append(at)
        return self.field(at.astype(float))


def dense(field):
    return field(np.moveaxis(np.indices((SIZE + 1,) * 3), 0, -1).astype(float))


def surface(values):
    return isosurface(values, LEVEL, np.zeros(3), 1.0)


@pytest.mark.parametrize("name", SOLIDS)
def test_the_surface_is_that_of_all_lattice_points(name):
    values, _, _ = mise(SOLIDS[name], at_level, CELLS, SUBDIVISIONS)
    for result, true in zip(surface(values), surface(dense(SOLIDS[name])), strict=True):
        np.testing.assert_array_equal(result, true)
    np.testing.assert_array_equal(values > LEVEL, dense(SOLIDS[name]) > LEVEL)


@pytest.mark.parametrize("name", SOLIDS)
def test_no_point_is_asked_for_twice_and_all_are_counted(name):
    field = RecordingField(SOLIDS[name])
    values, _, count = mise(field, at_level, CELLS, SUBDIVISIONS)
    at = np.concatenate(field.at)
    assert len(np.unique(at, axis=0)) == len(at) == count
    np.testing.assert_array_equal(values[tuple(at.T)], field.field(at.astype(float)))


def test_it_asks_near_the_surface_alone():
    """The ball of the published lattice: 32 cells, halved twice."""
    field = ball((64, 64, 64), 40)
    _, _, count = mise(field, lambda values: 0.0, 32, 2)
    # The coarse lattice, 1.7 % of all, and of the others those within two coarse cells' diagonals
    # of the surface at the most: 4 pi 40^2 * 2 * 4 * 3^0.5 points of 129^3 at the full density.
    assert 33**3 < count < 33**3 + 4 * np.pi * 40**2 * 2 * 4 * 3**0.5 < 0.15 * 129**3


def test_without_a_surface_only_the_coarse_lattice_is_asked():
    values, _, count = mise(lambda at: np.full(len(at), -3.0), at_level, CELLS, SUBDIVISIONS)
    assert count == (CELLS + 1) ** 3
    np.testing.assert_array_equal(values, np.full((SIZE + 1,) * 3, -3.0))


def test_an_island_inside_one_coarse_cell_is_missed():
    """The price: a ball of half a coarse cell about its center."""
    values, _, _ = mise(ball((10, 10, 10), 2), at_level, CELLS, SUBDIVISIONS)
    assert not (values > LEVEL).any()


def test_without_subdivisions_it_is_the_lattice_itself():
    field = SOLIDS["ball"]
    values, _, count = mise(field, at_level, SIZE, 0)
    np.testing.assert_array_equal(values, dense(field))
    assert count == (SIZE + 1) ** 3


def test_the_level_is_chosen_on_the_coarse_lattice_and_holds_for_the_fine_one():
    field, seen = SOLIDS["ball"], []

    def mean(values):
        seen.append(values.copy())
        return float(values.mean())

    values, level, _ = mise(field, mean, CELLS, SUBDIVISIONS)
    (coarse,) = seen
    np.testing.assert_array_equal(
        coarse, dense(field)[:: 2**SUBDIVISIONS, :: 2**SUBDIVISIONS, :: 2**SUBDIVISIONS]
    )
    assert level == coarse.mean()
    np.testing.assert_array_equal(values > level, dense(field) > level)


@pytest.mark.parametrize("highest", [0.9, 0.05])
@pytest.mark.parametrize("thickness", [0.2, 1.0])
def test_a_thin_plate_is_never_empty_at_the_matched_level(highest, thickness):
    """Thinner than a cell, on one lattice plane or between two, and however unsure it is."""
    for height in (16.0, 17.3):

        def plate(at, height=height):
            off = np.maximum(np.abs(at[:, 2] - height) - thickness / 2, 0)
            return highest * np.exp(-off)

        values, level, _ = mise(plate, volume_matched_level, CELLS, SUBDIVISIONS)
        vertices, faces = isosurface(values, level, np.zeros(3), 1.0)
        assert len(faces)
        assert np.ptp(vertices, axis=0)[:2].min() >= SIZE
        assert np.abs(vertices[:, 2] - height).max() < 2 * 2**SUBDIVISIONS
