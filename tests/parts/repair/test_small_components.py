"""Dirt goes, screws stay."""

import numpy as np

from industnerf.parts.repair.small_components import drop_small_components
from tests.parts.repair.shapes import ball, box, concatenated, settings

UNIT = box((0.6, 0.6, np.sqrt(1 - 0.72)))  # of diagonal 1; its area is 1.99


def small_boxes(count, size):
    return [box((size,) * 3, (0.4, 0.4, i / count - 0.5)) for i in range(count)]


def test_dirt_goes_and_is_counted():
    [mesh], repairs, defects = drop_small_components(
        [concatenated(UNIT, *small_boxes(25, 1e-3))], settings()
    )
    np.testing.assert_array_equal(mesh.triangles, UNIT.triangles)
    area = 2 * 0.36 + 4 * 0.6 * np.sqrt(1 - 0.72)
    share = 25 * 6e-6 / (area + 25 * 6e-6)
    assert repairs == [f"small components removed: 25 loose pieces with {share:.2%} of the area"]
    assert defects == []


def test_a_solid_of_its_own_is_a_screw_however_small():
    solids = [UNIT, *small_boxes(25, 1e-3)]
    assert drop_small_components(solids, settings()) == (solids, [], [])


def test_a_small_solid_still_loses_its_own_dirt():
    screw = concatenated(*small_boxes(1, 1e-2), box((1e-4,) * 3, (0.3, 0.3, 0.3)))
    [_, repaired], repairs, _ = drop_small_components([UNIT, screw], settings())
    assert len(repaired.faces) == 12
    assert len(repairs) == 1


def test_too_many_small_components_all_stay():
    mesh = concatenated(UNIT, *small_boxes(100, 0.015))
    share = 100 * 6 * 0.015**2 / (UNIT_AREA + 100 * 6 * 0.015**2)
    assert share > 0.05
    solids, repairs, defects = drop_small_components([mesh], settings())
    assert solids == [mesh]
    assert repairs == []
    assert defects == [
        f"small components left: 100 loose pieces with {share:.2%} of the area, more than "
        "parts.repair.max_removed_area (5.00%)"
    ]


def test_both_bounds_must_hold():
    """A long wire has little area, a thick pebble little length: neither is small."""
    wire, pebble = box((0.5, 1e-4, 1e-4)), ball(0.008, (0.4, 0.0, 0.0))
    mesh = concatenated(UNIT, wire)
    assert drop_small_components([mesh], settings()) == ([mesh], [], [])
    mesh = concatenated(UNIT, pebble)
    assert drop_small_components([mesh], settings(small_component_area=1e-4)) == ([mesh], [], [])
    assert drop_small_components([mesh], settings(small_component_size=0.02)) == ([mesh], [], [])
    assert len(drop_small_components([mesh], settings())[1]) == 1  # 2 x 0.008 x sqrt(3) < 0.03


def test_none_are_sought_with_a_bound_of_0():
    mesh = concatenated(UNIT, *small_boxes(3, 1e-3))
    assert drop_small_components([mesh], settings(small_component_area=0.0)) == ([mesh], [], [])


UNIT_AREA = 2 * 0.36 + 4 * 0.6 * np.sqrt(1 - 0.72)
