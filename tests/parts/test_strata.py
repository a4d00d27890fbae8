"""Strata of solids whose thickness, holes, pockets and symmetries are known in closed form."""

from functools import cache

import numpy as np
import pytest

from industnerf.artifacts.part import Mesh
from industnerf.parts.strata import NUM_SAMPLES, STRATUM_DEFINITIONS, ShapeProperties, measure_shape
from tests.solids import (
    GENERIC_ROTATION,
    ball,
    box,
    combine_meshes,
    cup,
    prism,
    torus,
    transform_mesh,
    tube,
)

HOLLOW = combine_meshes(
    ball(10),
    Mesh.with_one_appearance(ball(5).vertices, np.ascontiguousarray(ball(5).faces[:, ::-1])),
)
SOLIDS = {
    "ball": (ball(10), ("symmetric",)),
    "cube": (box(20, 20, 20), ("symmetric",)),
    "box": (box(20, 30, 40), ()),
    "plate": (box(100, 80, 1), ("thin",)),
    "hexagonal prism": (prism(6, 10, 8), ("symmetric",)),
    "tube": (tube(5, 7, 20), ("holes", "symmetric")),
    "torus": (torus(20, 5), ("holes", "symmetric")),
    "cup": (cup(8, 10, 2, 20), ("pockets", "symmetric")),
    "hollow ball": (HOLLOW, ("pockets", "symmetric")),
    "two balls": (
        combine_meshes(ball(5), transform_mesh(ball(5), offset=(20, 0, 0))),
        ("symmetric", "multi-body"),
    ),
    "two odd boxes": (
        combine_meshes(box(2, 3, 5), transform_mesh(box(3, 2, 6), offset=(7, 1, 2))),
        ("multi-body",),
    ),
    "open sheet": (
        Mesh.with_one_appearance(box(9, 7, 5).vertices, box(9, 7, 5).faces[:2]),
        ("thin",),
    ),
}
every_solid = pytest.mark.parametrize("name", SOLIDS)


@cache
def shape(name: str) -> ShapeProperties:
    return measure_shape(SOLIDS[name][0])


@every_solid
def test_strata_of_known_solids(name):
    assert shape(name).strata == SOLIDS[name][1]


@every_solid
def test_scale_and_place_do_not_matter(name):
    """Up to rounding: 1e-6 of the size in embree, and 1e-12 in where a sample falls."""
    here = shape(name)
    there = measure_shape(transform_mesh(SOLIDS[name][0], scale=25.4, offset=(1e3, -2e3, 5e2)))
    assert there.thickness == pytest.approx(here.thickness, rel=0, abs=1e-5)
    assert there.hull_hidden_share == pytest.approx(here.hull_hidden_share, abs=2 / NUM_SAMPLES)
    assert there.strata == here.strata


@every_solid
def test_nor_does_the_pose(name):
    """The box's diagonal turns with the part, and with it the thresholds, by up to sqrt(3)."""
    mesh, expected = SOLIDS[name]
    assert measure_shape(transform_mesh(mesh, rotation=GENERIC_ROTATION)).strata == expected


def test_equal_meshes_have_equal_strata():
    assert measure_shape(cup(8, 10, 2, 20)) == shape("cup")


def test_walls_are_as_thick_as_drawn():
    """Opposite facets of a bore and its tube are parallel, and the wall the apothem's share of 2.

    The ends, 2 % of the area here, are thicker than the wall and cannot move the median.
    """
    wall = 2 * np.cos(np.pi / 64)
    diagonal = np.linalg.norm([14, 14, 200])
    assert measure_shape(tube(5, 7, 200)).thickness == pytest.approx(wall / diagonal, rel=1e-4)
    # Of a ball of icosahedral facets, from the inscribed to the circumscribed radius.
    assert shape("ball").thickness * np.linalg.norm([20] * 3) == pytest.approx(20, rel=5e-3)


def test_the_hidden_share_of_a_cup_is_its_inside():
    inner, outer, floor, height = 8.0, 10.0, 2.0, 20.0
    inside = 2 * np.pi * inner * (height - floor) + np.pi * inner**2
    whole = inside + 2 * np.pi * outer * height + np.pi * (2 * outer**2 - inner**2)
    share = inside / whole
    # Five standard errors, to be exceeded once in a million seeds; the seed is fixed.  Sixty-four
    # facets lose 0.2 % of a circle's area, of the inside and the outside alike.
    error = 5 * np.sqrt(share * (1 - share) / NUM_SAMPLES)
    hidden_share = shape("cup").hull_hidden_share
    assert hidden_share == pytest.approx(share, abs=error)


def test_every_stratum_follows_from_its_threshold():
    least = ShapeProperties(0.02, 0, 0.0499, None, 1)
    most = ShapeProperties(0.0199, 1, 0.05, 3, 2)
    assert least.strata == ()
    assert most.strata == tuple(STRATUM_DEFINITIONS)


def test_a_mesh_without_area_is_refused():
    line = Mesh.with_one_appearance(
        np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]), np.array([[0, 1, 2]], np.int32)
    )
    with pytest.raises(ValueError, match="no area"):
        measure_shape(line)
