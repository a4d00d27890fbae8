"""The surface on which the views agree, from pixels that see a ball more or less exactly."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from industnerf.config import load_params
from industnerf.geometry.cameras import Cameras, framed_ball
from industnerf.methods.industnerf.fused import depth_images, fused
from industnerf.methods.industnerf.scene import Posed
from industnerf.methods.industnerf.witnesses import Surface, joined
from tests.methods.solids import cameras_around, rays

SETTINGS = load_params(Path(__file__).parents[3] / "params.yaml").method.industnerf
PX, CELLS, POINTS = 64, 64, 4000
WAYS = replace(
    SETTINGS,
    surface_px=PX,
    fusion=replace(SETTINGS.fusion, grid_res=CELLS, truncation=3.0, points=POINTS),
)
CAMERAS = cameras_around(40, PX, 1.0)
CENTRE, REACH = framed_ball(CAMERAS)  # about the origin, 1.06
CELL, RADIUS = 2 / CELLS, 0.6


def posed(cameras: Cameras = CAMERAS) -> Posed:
    images = np.zeros((len(cameras), cameras.height, cameras.width, 3), np.uint8)
    return Posed(images, cameras, None, CENTRE, REACH)


def sees_ball(cameras: Cameras, view: int, noise: float, rng: np.random.Generator) -> Surface:
    """Where the pixels of one view meet a ball, shifted along their rays; in the unit frame."""
    eye, towards = cameras.eyes[view] / REACH, rays(cameras, view)
    half = towards @ eye
    root = half**2 - eye @ eye + RADIUS**2
    towards, half, root = (values[root > 0] for values in (towards, half, root))
    along = -half - np.sqrt(root) + noise * rng.normal(size=len(root))
    points = torch.tensor(eye + along[:, None] * towards).float()
    sure = torch.ones(len(points))
    return Surface(points, sure[:, None].repeat(1, 3) / 2, sure, torch.full((len(sure),), view))


def seen(noise: float = 0.0, cameras: Cameras = CAMERAS) -> Surface:
    rng = np.random.default_rng(0)
    return joined([sees_ball(cameras, view, noise, rng) for view in range(len(cameras))])


def off(surface: Surface) -> np.ndarray:
    """Signed distances from the ball."""
    return surface.points.norm(dim=1).numpy() - RADIUS


def test_a_ball_that_is_seen_exactly_is_found_to_a_fraction_of_a_cell():
    found = fused(seen(), posed(), WAYS, 0)
    assert len(found.points) == POINTS
    # a pixel's depth stands for points up to half a pixel aside, 0.02 times the slope of its ray
    assert np.abs(off(found)).max() < 0.5 * CELL
    assert abs(off(found).mean()) < 0.05 * CELL


def test_what_views_see_differently_is_averaged():
    """Noise of half a cell in every pixel; some 15 views see a point, and a cell several pixels."""
    noise = 0.5 * CELL
    rough = seen(noise)
    found = fused(rough, posed(), WAYS, 0)
    exact = fused(seen(), posed(), WAYS, 0)
    assert off(rough).std() > 0.6 * noise  # it is along rays, which are slanted
    added = np.sqrt(max(off(found).std() ** 2 - off(exact).std() ** 2, 0))
    assert (
        added < off(rough).std() / 2
    )  # sqrt(15) = 3.9 were it not for what is seen empty by any one view


def test_pixels_that_are_not_sure_are_as_good_as_none():
    """A view that sees far behind the ball, and doubts it, does not hollow it out."""
    right, (first, wrong) = seen(), (0, 1.2)
    lies = right.view == first
    eye = torch.tensor(CAMERAS.eyes[first] / REACH).float()
    points = torch.where(
        lies[:, None], right.points + wrong * (right.points - eye) / 4, right.points
    )
    doubted = torch.where(lies, 0.4, 1.0)
    kept = fused(replace(right, points=points, confidence=doubted), posed(), WAYS, 0)
    assert np.abs(off(kept)).max() < 0.5 * CELL
    believed = fused(replace(right, points=points), posed(), WAYS, 0)
    assert off(believed).min() < -5 * CELL


def test_what_no_pixel_looks_at_bounds_what_is_seen_empty_and_nobody_vouches_for_it():
    """From above alone: behind the ball its shadow is left, down to the end of X."""
    above = CAMERAS[np.argmax(CAMERAS.eyes[:, 2])[None]]
    found = fused(seen(cameras=above), posed(above), WAYS, 0)
    shown = found.points[:, 2] > 0.4
    assert (found.view[shown] == 0).all()
    assert (found.confidence[shown] == 1).all()
    shadow = found.points[:, 2] < -0.5
    assert shadow.sum() > POINTS / 10
    assert (found.view[shadow] == -1).all()
    assert (found.confidence[shadow] == 0).all()


def test_points_take_colour_confidence_and_view_from_the_pixels_next_to_them():
    pixels = seen()
    shade = (pixels.points[:, :1] > 0).float().repeat(1, 3)
    trust = torch.where(pixels.points[:, 2] > 0, 0.9, 0.6)
    found = fused(replace(pixels, rgb=shade, confidence=trust), posed(), WAYS, 0)
    for axis, values, high, low in ((0, found.rgb[:, 0], 1, 0), (2, found.confidence, 0.9, 0.6)):
        beyond = found.points[:, axis].abs() > 2 * CELL  # nearer, either side may be the nearest
        expected = torch.where(found.points[:, axis] > 0, high, low).float()
        assert torch.equal(values[beyond], expected[beyond])
    facing = (found.points * torch.tensor(CAMERAS.eyes)[found.view].float()).sum(dim=1)
    assert (facing > 0).all()  # its view is on its side of the ball


def test_the_same_seed_draws_the_same_points():
    once, again, other = (fused(seen(), posed(), WAYS, seed).points for seed in (0, 0, 1))
    assert torch.equal(once, again)
    assert not torch.equal(once, other)


def test_nothing_sure_and_nothing_seen_are_no_points():
    pixels = seen()
    for doubtful in (
        replace(pixels, confidence=torch.zeros(len(pixels.view))),
        Surface(*(values[:0] for values in vars(pixels).values())),
    ):
        assert len(fused(doubtful, posed(), WAYS, 0).points) == 0


@pytest.mark.parametrize("longest", [24, 48])
def test_depths_stand_in_the_pixels_whose_rays_they_are_on(longest):
    """Of images that are not square and are brought down; a ray through each pixel's centre."""
    cameras = Cameras(CAMERAS.K, CAMERAS.c2w, 48, 32)
    wide, tall = longest, longest * 32 // 48
    small = CAMERAS.K.copy()
    small[:, 0] *= wide / 48
    small[:, 1] *= tall / 32
    reduced = Cameras(small, CAMERAS.c2w, wide, tall)
    pixels = seen(cameras=reduced)
    sure = np.ones(len(pixels.view), bool)
    depth, projections = depth_images(pixels, sure, posed(cameras), longest)
    assert depth.shape == (40, tall, wide)
    assert projections.shape == (40, 3, 4)
    for view in (0, 7):
        own = pixels.points[pixels.view == view].double().numpy()
        z = (own - CAMERAS.eyes[view] / REACH) @ CAMERAS.c2w[view, :3, 2]
        assert (depth[view] > 0).sum() == len(own)
        np.testing.assert_allclose(depth[view][depth[view] > 0], z, rtol=1e-5)  # row by row
