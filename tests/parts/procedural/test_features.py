"""What solids are made of, against closed forms of the polygons that stand for circles."""

import numpy as np
import pytest

from industnerf.parts.procedural.features import ABOVE, bore_tool, threaded_rod
from industnerf.parts.procedural.primitives import (
    SIDES,
    block,
    cylinder,
    eased_prism,
    facing,
    prism,
    rounded_block,
    smooth_path,
    swept,
    turned,
    turned_outline,
)
from industnerf.parts.procedural.profiles import (
    SEGMENTS,
    circle,
    contains,
    fillet,
    polygon,
    rectangle,
    rounded_rectangle,
    scatter,
    section_union,
    wall,
)
from industnerf.parts.procedural.sampler import Sampler


def polygon_area(radius: float, segments: int = SEGMENTS) -> float:
    """Of a regular polygon in a circle."""
    return segments / 2 * np.sin(2 * np.pi / segments) * radius**2


class Fixed(Sampler):
    """Takes the low end, the first option and `yes`, always."""

    def __init__(self, yes: bool):
        super().__init__(np.random.default_rng(0))
        self.yes = yes

    def uniform(self, low, high):
        return low

    def pick(self, options):
        return options[0]

    def chance(self, probability):
        return self.yes


@pytest.mark.parametrize("is_conical", [False, True])
def test_a_bored_cylinder(is_conical):
    """A plain bore of depth d removes A d, and a drill's tip of height t removes A t / 3 more."""
    radius, depth = 0.25, 0.8
    tool = bore_tool(Fixed(is_conical), radius, depth).translate([0, 0, 1])
    body = cylinder(1, 2) - tool
    removed = polygon_area(radius) * (depth + is_conical * 0.58 * radius / 3)
    assert body.volume() == pytest.approx(2 * polygon_area(1) - removed, rel=1e-6)


def test_a_bore_starts_above_the_surface():
    box = bore_tool(Sampler(np.random.default_rng(3)), 0.1, 0.5).bounding_box()
    assert box[5] == pytest.approx(ABOVE, abs=1e-5)


def test_a_filleted_square_lacks_its_corners():
    """Each corner loses r^2 less a quarter of the disc; arcs are polygons inside it."""
    radius, square = 0.2, rectangle(1, 1)
    area = fillet(square, radius).area()
    assert 1 - (4 - np.pi) * radius**2 > area > 1 - (4.1 - np.pi) * radius**2
    assert rounded_rectangle(1, 1, radius).area() == pytest.approx(area, rel=1e-9)


def test_a_fillet_fills_the_inner_corner():
    angle = section_union([rectangle(1, 0.2, (0.5, 0.1)), rectangle(0.2, 1, (0.1, 0.5))])
    added = fillet(angle, 0, 0.1).area() - angle.area()
    assert 0 < added - (1 - np.pi / 4) * 0.1**2 < 0.1 * 0.1**2


def test_a_chamfered_square_prism():
    """A chamfer c takes a frustum's difference from either end of a square of side a."""
    a, height, c = 1.0, 0.6, 0.1
    small = a - 2 * c
    frustum = c / 3 * (a**2 + small**2 + a * small)
    body = eased_prism(rectangle(a, a), 0, height, c, 1)
    assert body.volume() == pytest.approx(a**2 * (height - 2 * c) + 2 * frustum, rel=1e-5)


def test_rounded_edges_take_less_than_a_chamfer():
    section = rectangle(1, 1)
    chamfered, rounded = (eased_prism(section, 0, 1, 0.2, steps).volume() for steps in (1, 6))
    assert chamfered < rounded < 1


def test_a_rounded_block_has_its_size():
    size = (1.0, 0.6, 0.4)
    box = np.reshape(rounded_block(size, 0.1).bounding_box(), (2, 3))
    np.testing.assert_allclose(np.ptp(box, axis=0), size, atol=1e-9)


def test_a_turned_step_is_two_cylinders():
    body = turned(turned_outline(np.array([(1, 0), (1, 1), (0.5, 1), (0.5, 3.0)])))
    assert body.volume() == pytest.approx(polygon_area(1) + 2 * polygon_area(0.5), rel=1e-6)


def test_a_thread_has_the_volume_of_its_section():
    """Triangles along the helix: the surface is neither cut nor bulged by more than 1 %."""
    radius, depth, length = 1.0, 0.3, 2.0
    body = threaded_rod(radius, depth, length, 4, 1, False)
    reach = radius - depth + depth * (1 - np.abs(2 * np.arange(24) / 24 - 1))
    area = np.sin(2 * np.pi / 24) / 2 * (reach * np.roll(reach, 1)).sum()
    assert body.volume() == pytest.approx(area * length, rel=0.01)


def test_a_thread_is_right_handed():
    """Turned and lifted along its helix, it is where it was; turned the other way, it is not."""
    body = threaded_rod(1, 0.3, 2, 4, 1, False)
    right, left = (
        (body ^ body.rotate([0, 0, turn]).translate([0, 0, 0.125])).volume() for turn in (90, -90)
    )
    assert right > 1.02 * left


def test_a_straight_sweep_is_a_prism():
    path = np.stack([np.zeros(5), np.linspace(0, 2, 5), np.zeros(5)], axis=1)
    ring = circle(0.3) - circle(0.2)
    assert swept(ring, path).volume() == pytest.approx(2 * ring.area(), rel=1e-5)


def test_a_closed_bend_has_the_volume_of_pappus():
    turn = np.linspace(0, np.pi, 60)
    path = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    body = swept(rectangle(0.2, 0.3), path)
    assert body.volume() == pytest.approx(np.pi * 0.2 * 0.3, rel=5e-3)


def test_a_smooth_path_passes_its_knots():
    knots = np.array([[0, 0, 0], [1, 2, 0], [2, 0, 1], [4, 1, 1.0]])
    np.testing.assert_allclose(smooth_path(knots, 6)[::6], knots, atol=1e-12)


@pytest.mark.parametrize("side", SIDES)
def test_facing_takes_z_to_its_side(side):
    low, high = np.reshape(facing(side, block((0.1, 0.1, 1), (0, 0, 2))).bounding_box(), (2, 3))
    center = (low + high) / 2
    expected = np.zeros(3)
    expected["xyz".index(side[1])] = 2 if side[0] == "+" else -2
    np.testing.assert_allclose(center, expected, atol=1e-12)


def test_a_clockwise_polygon_is_the_same_section():
    corners = [(0, 0), (1, 0), (0, 1)]
    assert polygon(corners[::-1]).area() == polygon(corners).area() == 0.5


def test_contains_knows_holes():
    ring = circle(1) - circle(0.5)
    points = np.array([[0.75, 0], [0, 0], [0, -0.75], [2, 0]])
    np.testing.assert_array_equal(contains(ring, points), [True, False, True, False])


def test_scattered_circles_keep_their_distance():
    section, gap = rounded_rectangle(2, 1, 0.2), 0.05
    placed = np.array(scatter(Sampler(np.random.default_rng(1)), section, 12, 0.05, 0.2, gap))
    assert len(placed) >= 6
    for i, (x, y, radius) in enumerate(placed):
        away = np.hypot(*(placed[:i, :2] - [x, y]).T) - radius - placed[:i, 2]
        assert (away >= gap - 1e-9).all()
        disc = circle(radius, (x, y))
        assert (disc - section).area() < 1e-9


def test_a_straight_wall_is_a_strip_with_round_ends():
    section = wall(np.array([[0, 0], [1, 0], [2, 0.0]]), 0.2)
    assert section.area() == pytest.approx(2 * 0.2 + polygon_area(0.1, 16), rel=1e-5)


def test_a_prism_stands_between_its_levels():
    assert prism(rectangle(1, 1), -0.25, 0.5).bounding_box() == (-0.5, -0.5, -0.25, 0.5, 0.5, 0.5)
