"""The twin against closed forms, and against the same written as loops."""

import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.rendering.torch_renderer import render_reference
from industnerf.rendering.weights import inverse_distance_weights
from tests.rendering.loops import render_loops
from tests.rendering.point_grids import f64, point_grid, render_points
from tests.rendering.scenes import SCENES, random_scene

READINGS = ["inverse", "inverse_square", "modified_shepard"]
SEEDS = st.integers(0, 2**32 - 1)
RED, BLUE, GRAY = [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.5, 0.5, 0.5]
FROM_LEFT = f64([-3, 0, 0]), f64([1, 0, 0])


def assert_same(mine, truth, **tolerance):
    for name, value in vars(truth).items():
        torch.testing.assert_close(getattr(mine, name), value, **tolerance)


@pytest.mark.parametrize("name", SCENES)
def test_loops_see_the_same(name):
    scene = SCENES[name]
    mine = render_reference(*scene.render_inputs, **scene.settings)
    # Sums of some hundred terms in another order, and depths divided by an opacity that is
    # rounded to 1e-16 and may be 1e-3.
    assert_same(mine, render_loops(scene), rtol=0, atol=1e-11)


@pytest.mark.parametrize("weights", READINGS)
def test_a_slab_square_on(weights):
    """1 - exp(-sigma length), to the last digits.

    The slab's faces lie midway between layers of the lattice, full on one side and empty on the
    other, so that the density at mirrored places sums to sigma; steps fit the slab and are
    mirrored too.  Hence the steps count sigma exactly length / step times.
    """
    points = point_grid((40, 6, 6), 0.1)  # layers at -1.95, -1.85, ...
    sigma = 1.5 * (points[:, 0].abs() < 0.5)  # ten layers
    rendered = render_points(
        *FROM_LEFT, points, sigma, step=0.02, radius=0.17, k=40, weights=weights
    )
    truth = 1 - math.exp(-1.5 * 1.0)
    torch.testing.assert_close(rendered.opacity, f64(truth), rtol=0, atol=1e-13)


@pytest.mark.parametrize("angle_deg", [0, 25, 50])
def test_a_slab_at_an_angle(angle_deg):
    """The density is sigma farther than `radius` inside the faces, and 0 farther than it outside.

    Between the two the ray's length is anyone's guess, and so is a step at each end.
    """
    step, radius, cos = 0.01, 0.06, math.cos(math.radians(angle_deg))
    points = point_grid((26, 60, 3), 0.04)
    sigma = 1.5 * (points[:, 0].abs() < 0.4)
    direction = f64([cos, math.sin(math.radians(angle_deg)), 0])
    rendered = render_points(
        -3 * direction, direction, points, sigma, step=step, radius=radius
    ).opacity.item()
    shortest, longest = ((0.8 + sign * 2 * radius) / cos + sign * 2 * step for sign in (-1, 1))
    assert 1 - math.exp(-1.5 * shortest) <= rendered <= 1 - math.exp(-1.5 * longest)


@pytest.mark.parametrize("offset", [0.0, 0.3, 0.55])
def test_a_ball(offset):
    """As the slab: the chord is that of a ball smaller or larger by `radius`, within a step."""
    step, radius, size, sigma = 0.01, 0.07, 0.7, 2.0
    points = point_grid((38, 38, 38), 0.04)
    inside = points.norm(dim=1) < size
    direction = torch.nn.functional.normalize(f64([1, 2, 3]), dim=1)
    across = torch.nn.functional.normalize(f64([3, 0, -1]), dim=1)
    origin = offset * across - 1.9 * direction
    near = (points @ direction[0])[:, None] * direction + offset * across - points
    some = near.norm(dim=1) < 2 * radius  # the others are out of the ray's reach
    rendered = render_points(
        origin, direction, points[some], sigma * inside[some], step=step, radius=radius
    )
    chord = [2 * math.sqrt(max(0, (size + sign * radius) ** 2 - offset**2)) for sign in (-1, 1)]
    minimum = 1 - math.exp(-sigma * (chord[0] - step))
    most = 1 - math.exp(-sigma * (chord[1] + step))
    assert minimum <= rendered.opacity.item() <= most


def test_two_planes():
    """Sheets of points at x = -1 and 1, seen from either side through a point of both.

    On the ray a sheet is as thick as the radius allows: steps at 0.1 (q + 1/2) from it, so that
    the four at 0.05 and 0.15 either way are within 0.2.
    """
    sheet = point_grid((1, 5, 5), 0.25)
    points = torch.cat([sheet - f64(1, 0, 0), sheet + f64(1, 0, 0)])
    sigma = torch.cat([torch.full((25,), 1.0), torch.full((25,), 4.0)]).double()
    rgb = torch.cat([f64(RED).expand(25, 3), f64(BLUE).expand(25, 3)])
    rendered = render_points(
        f64([-3, 0, 0], [3, 0, 0]),
        f64([1, 0, 0], [-1, 0, 0]),
        points,
        sigma,
        rgb=rgb,
        background=f64(GRAY, GRAY),
        step=0.1,
        radius=0.2,
    )
    faint, dense = 1 - math.exp(-1.0 * 4 * 0.1), 1 - math.exp(-4.0 * 4 * 0.1)
    end = 0.5 * (1 - faint) * (1 - dense)  # gray behind both
    truth = f64(
        [faint + end, end, (1 - faint) * dense + end],
        [faint * (1 - dense) + end, end, dense + end],
    )
    torch.testing.assert_close(rendered.rgb, truth, rtol=0, atol=1e-14)  # a few eps


@pytest.mark.parametrize("place", [-0.7, 0.02, 1.3])
def test_the_depth_of_an_opaque_plane_is_its_first_sample(place):
    sheet = point_grid((1, 5, 5), 0.25) + f64(place, 0, 0)
    step, radius = 0.04, 0.15
    rendered = render_points(
        *FROM_LEFT, sheet, torch.full((25,), 1e9).double(), step=step, radius=radius
    )
    # The ray enters the cube at t = 1, x = -2, and passes through a point of the sheet.
    first = math.floor((place - radius + 2) / step - 0.5) + 1
    assert rendered.depth.item() == pytest.approx(1 + (first + 0.5) * step, abs=1e-14)
    assert place + 3 - radius < rendered.depth.item() <= place + 3 - radius + step


@pytest.mark.parametrize("weights", READINGS)
def test_a_point_on_a_sample_is_not_the_only_one(weights):
    """One sample, at the origin, with a point on it and one at 0.3."""
    points, sigma = f64([0, 0, 0], [0, 0.3, 0]), f64(2, 8)
    rendered = render_points(
        f64([-2, 0, 0]), f64([1, 0, 0]), points, sigma, step=4.0, radius=0.5, weights=weights
    )
    on, aside = {
        "inverse": (1 / 5e-4, 1 / 0.3),
        "inverse_square": (1 / 5e-4**2, 1 / 0.09),
        "modified_shepard": (1 / 5e-4**2, (0.2 / (0.5 * 0.3)) ** 2),
    }[weights]
    mean = (2 * on + 8 * aside) / (on + aside)
    torch.testing.assert_close(rendered.opacity, f64(1 - math.exp(-4 * mean)), rtol=1e-14, atol=0)


def test_one_neighbor_of_a_crowd_is_the_nearest():
    points, sigma = 0.2 * torch.rand(30, 3).double() + 0.01, torch.rand(30).double()
    rendered = render_points(
        f64([-2, 0, 0]), f64([1, 0, 0]), points, sigma, step=4.0, radius=0.5, k=1
    )
    nearest = sigma[points.norm(dim=1).argmin()].item()
    assert rendered.opacity.item() == pytest.approx(1 - math.exp(-4 * nearest), rel=1e-14)


def test_some_neighbors_of_a_crowd_are_the_nearest():
    points, sigma = 0.2 * torch.rand(30, 3).double() + 0.01, torch.rand(30).double()
    rendered = render_points(
        f64([-2, 0, 0]), f64([1, 0, 0]), points, sigma, step=4.0, radius=0.5, k=3
    )
    distance, three = points.norm(dim=1).sort()
    weight = inverse_distance_weights(distance[:3], 0.5, "inverse")
    mean = (weight @ sigma[three[:3]] / weight.sum()).item()
    assert rendered.opacity.item() == pytest.approx(1 - math.exp(-4 * mean), rel=1e-14)


def test_no_cloud_shows_the_background():
    nothing = torch.empty(0, 3).double()
    rendered = render_points(
        *FROM_LEFT, nothing, nothing[:, 0], background=f64(GRAY), step=0.1, radius=0.3
    )
    assert rendered.rgb.tolist() == [GRAY]
    assert rendered.opacity.item() == 0


@pytest.mark.parametrize("name", SCENES)
def test_the_order_of_the_points_does_not_matter(name):
    scene = SCENES[name]
    order = torch.randperm(len(scene.points), generator=torch.Generator().manual_seed(0))
    points, sigma, rgb = (x[order] for x in (scene.points, scene.sigma, scene.rgb))
    mine = render_reference(*scene.rays, points, sigma, rgb, scene.background, **scene.settings)
    # No point is as far as another, so the neighbors come in the same order, bit by bit; but on a
    # lattice, where eight terms are added in another.
    roundings = 1e-14 if name == "grid" else 0
    assert_same(
        mine, render_reference(*scene.render_inputs, **scene.settings), rtol=0, atol=roundings
    )


@given(SEEDS, st.sampled_from(READINGS))
def test_colors_stay_in_range(seed, weights):
    scene = random_scene(seed, 100, rays=12, step=0.125, weights=weights)
    rendered = render_reference(*scene.render_inputs, **scene.settings)
    assert (rendered.rgb >= 0).all()
    assert (rendered.rgb <= 1 + 1e-14).all()  # weights that sum to 1 within a few eps


@given(SEEDS, st.floats(0, 0.5))
def test_ending_early_changes_a_pixel_by_at_most_its_threshold(seed, early_stop):
    scene = random_scene(seed, 100, rays=12, step=0.125, density=10.0)
    full = render_reference(
        *scene.render_inputs, **scene.settings | {"early_stop_transmittance": 0.0}
    )
    early = render_reference(
        *scene.render_inputs, **scene.settings | {"early_stop_transmittance": early_stop}
    )
    # What is dropped and what replaces it both weigh less than `early_stop`; colors are in [0, 1].
    assert (early.rgb - full.rgb).abs().max() <= early_stop + 1e-14


def test_ending_early_does_change_pixels():
    scene = SCENES["opaque"]
    full = render_reference(
        *scene.render_inputs, **scene.settings | {"early_stop_transmittance": 0.0}
    )
    early = render_reference(*scene.render_inputs, **scene.settings)
    assert (early.rgb - full.rgb).abs().max() > 1e-4


@pytest.mark.parametrize("early_stop", [0.0, 0.05])
@pytest.mark.parametrize("weights", READINGS)
def test_gradients(weights, early_stop):
    scene = random_scene(
        8,
        12,
        rays=6,
        step=0.25,
        radius=0.6,
        k=3,
        weights=weights,
        early_stop_transmittance=early_stop,
    )
    inputs = (scene.sigma + 0.1, scene.rgb, scene.background)

    def seen(*inputs):
        return tuple(
            vars(render_reference(*scene.rays, scene.points, *inputs, **scene.settings)).values()
        )

    torch.autograd.gradcheck(seen, tuple(x.clone().requires_grad_() for x in inputs))


@pytest.mark.parametrize("early_stop", [0.0, 0.05])
def test_gradients_of_distances(early_stop):
    """Away from where a density is cut off, at -6 and 6 beta: these reach 1 beta either way."""
    scene = random_scene(
        8,
        12,
        rays=6,
        step=0.25,
        radius=0.6,
        k=3,
        weights="trilinear",
        early_stop_transmittance=early_stop,
        beta=0.5,
    )
    values = scene.sigma.clamp(-0.5, 0.5)

    def seen(*inputs):
        rendered = render_reference(*scene.rays, scene.points, *inputs, **scene.settings)
        return tuple(vars(rendered).values())

    assert (1 - seen(values, scene.rgb, scene.background)[-1] > 0.1).any()
    inputs = (values, scene.rgb, scene.background)
    torch.autograd.gradcheck(seen, tuple(x.clone().requires_grad_() for x in inputs))


def test_positions_have_no_gradient():
    scene = random_scene(8, 12, rays=6)
    points = scene.points.clone().requires_grad_()
    moved = *scene.rays, points, scene.sigma, scene.rgb, scene.background
    assert not render_reference(*moved, **scene.settings).rgb.requires_grad


@pytest.mark.parametrize("name", SCENES)
def test_float32_in_float32_out_and_nearly_the_same(name):
    scene = SCENES[name]
    short = render_reference(*scene.to(torch.float32).render_inputs, **scene.settings)
    full = render_reference(*scene.render_inputs, **scene.settings)
    assert {x.dtype for x in vars(short).values()} == {torch.float32}
    # A place rounded by 3e-7 moves weights by 1e-4 at most, as the test of the scenes argues.
    torch.testing.assert_close(short.rgb.double(), full.rgb, rtol=0, atol=1e-4)
