"""The surface on which the views agree, from pixels that see a ball more or less exactly."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from industnerf.config import load_params
from industnerf.geometry.cameras import Cameras, common_view_ball
from industnerf.methods.industnerf.confidence import ObservedSurface, concatenate
from industnerf.methods.industnerf.extraction import fuse_surface, render_depth_maps
from industnerf.methods.industnerf.scene import PosedImages
from tests.methods.solids import cameras_around, rays

DEFAULTS = load_params(Path(__file__).parents[3] / "params.yaml").method.industnerf
PX, CELLS, POINTS = 64, 64, 4000
SETTINGS = replace(
    DEFAULTS,
    surface_px=PX,
    fusion=replace(DEFAULTS.fusion, grid_res=CELLS, truncation=3.0, points=POINTS),
)
CAMERAS = cameras_around(40, PX, 1.0)
CENTER, SCENE_RADIUS = common_view_ball(CAMERAS)  # about the origin, 1.06
CELL, RADIUS = 2 / CELLS, 0.6


def make_posed_images(cameras: Cameras = CAMERAS) -> PosedImages:
    images = np.zeros((len(cameras), cameras.height, cameras.width, 3), np.uint8)
    return PosedImages(images, cameras, None, CENTER, SCENE_RADIUS)


def ball_surface(
    cameras: Cameras, view: int, noise: float, rng: np.random.Generator
) -> ObservedSurface:
    """Where the pixels of one view meet a ball, shifted along their rays; in the unit frame."""
    center, directions = cameras.centers[view] / SCENE_RADIUS, rays(cameras, view)
    half = directions @ center
    root = half**2 - center @ center + RADIUS**2
    directions, half, root = (values[root > 0] for values in (directions, half, root))
    distance = -half - np.sqrt(root) + noise * rng.normal(size=len(root))
    points = torch.tensor(center + distance[:, None] * directions).float()
    confidence = torch.ones(len(points))
    return ObservedSurface(
        points,
        confidence[:, None].repeat(1, 3) / 2,
        confidence,
        torch.full((len(confidence),), view),
    )


def make_surface(noise: float = 0.0, cameras: Cameras = CAMERAS) -> ObservedSurface:
    rng = np.random.default_rng(0)
    return concatenate([ball_surface(cameras, view, noise, rng) for view in range(len(cameras))])


def surface_errors(surface: ObservedSurface) -> np.ndarray:
    """Signed distances from the ball."""
    return surface.points.norm(dim=1).numpy() - RADIUS


def test_a_ball_that_is_seen_exactly_is_found_to_a_fraction_of_a_cell():
    actual = fuse_surface(make_surface(), make_posed_images(), SETTINGS, 0)
    assert len(actual.points) == POINTS
    # a pixel's depth stands for points up to half a pixel aside, 0.02 times the slope of its ray
    assert np.abs(surface_errors(actual)).max() < 0.5 * CELL
    assert abs(surface_errors(actual).mean()) < 0.05 * CELL


def test_what_views_see_differently_is_averaged():
    """Noise of half a cell in every pixel; some 15 views see a point, and a cell several pixels."""
    noise = 0.5 * CELL
    noisy = make_surface(noise)
    actual = fuse_surface(noisy, make_posed_images(), SETTINGS, 0)
    exact = fuse_surface(make_surface(), make_posed_images(), SETTINGS, 0)
    assert surface_errors(noisy).std() > 0.6 * noise  # it is along rays, which are slanted
    added = np.sqrt(max(surface_errors(actual).std() ** 2 - surface_errors(exact).std() ** 2, 0))
    assert (
        added < surface_errors(noisy).std() / 2
    )  # sqrt(15) = 3.9 were it not for what is seen empty by any one view


def test_pixels_that_are_not_sure_are_as_good_as_none():
    """A view that sees far behind the ball, and doubts it, does not hollow it out."""
    right, (first, wrong) = make_surface(), (0, 1.2)
    is_wrong = right.view == first
    center = torch.tensor(CAMERAS.centers[first] / SCENE_RADIUS).float()
    points = torch.where(
        is_wrong[:, None], right.points + wrong * (right.points - center) / 4, right.points
    )
    confidence = torch.where(is_wrong, 0.4, 1.0)
    kept = fuse_surface(
        replace(right, points=points, confidence=confidence), make_posed_images(), SETTINGS, 0
    )
    assert np.abs(surface_errors(kept)).max() < 0.5 * CELL
    without_confidence = fuse_surface(
        replace(right, points=points), make_posed_images(), SETTINGS, 0
    )
    assert surface_errors(without_confidence).min() < -5 * CELL


def test_what_no_pixel_looks_at_bounds_what_is_seen_empty_and_nobody_vouches_for_it():
    """From above alone: behind the ball its shadow is left, down to the end of X."""
    above = CAMERAS[np.argmax(CAMERAS.centers[:, 2])[None]]
    actual = fuse_surface(make_surface(cameras=above), make_posed_images(above), SETTINGS, 0)
    is_visible = actual.points[:, 2] > 0.4
    assert (actual.view[is_visible] == 0).all()
    assert (actual.confidence[is_visible] == 1).all()
    is_shadowed = actual.points[:, 2] < -0.5
    assert is_shadowed.sum() > POINTS / 10
    assert (actual.view[is_shadowed] == -1).all()
    assert (actual.confidence[is_shadowed] == 0).all()


def test_points_take_color_confidence_and_view_from_the_pixels_next_to_them():
    pixels = make_surface()
    colors = (pixels.points[:, :1] > 0).float().repeat(1, 3)
    confidence = torch.where(pixels.points[:, 2] > 0, 0.9, 0.6)
    actual = fuse_surface(
        replace(pixels, rgb=colors, confidence=confidence), make_posed_images(), SETTINGS, 0
    )
    for axis, values, high, low in ((0, actual.rgb[:, 0], 1, 0), (2, actual.confidence, 0.9, 0.6)):
        beyond = actual.points[:, axis].abs() > 2 * CELL  # nearer, either side may be the nearest
        expected = torch.where(actual.points[:, axis] > 0, high, low).float()
        assert torch.equal(values[beyond], expected[beyond])
    facing = (actual.points * torch.tensor(CAMERAS.centers)[actual.view].float()).sum(dim=1)
    assert (facing > 0).all()  # its view is on its side of the ball


def test_the_same_seed_draws_the_same_points():
    once, again, other = (
        fuse_surface(make_surface(), make_posed_images(), SETTINGS, seed).points
        for seed in (0, 0, 1)
    )
    assert torch.equal(once, again)
    assert not torch.equal(once, other)


def test_nothing_sure_and_nothing_seen_are_no_points():
    pixels = make_surface()
    for unconfident in (
        replace(pixels, confidence=torch.zeros(len(pixels.view))),
        ObservedSurface(*(values[:0] for values in vars(pixels).values())),
    ):
        assert len(fuse_surface(unconfident, make_posed_images(), SETTINGS, 0).points) == 0


@pytest.mark.parametrize("image_px", [24, 48])
def test_depths_stand_in_the_pixels_whose_rays_they_are_on(image_px):
    """Of images that are not square and are brought down; a ray through each pixel's center."""
    cameras = Cameras(CAMERAS.K, CAMERAS.c2w, 48, 32)
    width, height = image_px, image_px * 32 // 48
    small = CAMERAS.K.copy()
    small[:, 0] *= width / 48
    small[:, 1] *= height / 32
    reduced = Cameras(small, CAMERAS.c2w, width, height)
    pixels = make_surface(cameras=reduced)
    is_confident = np.ones(len(pixels.view), bool)
    depth, projections = render_depth_maps(
        pixels, is_confident, make_posed_images(cameras), image_px
    )
    assert depth.shape == (40, height, width)
    assert projections.shape == (40, 3, 4)
    for view in (0, 7):
        view_points = pixels.points[pixels.view == view].double().numpy()
        z = (view_points - CAMERAS.centers[view] / SCENE_RADIUS) @ CAMERAS.c2w[view, :3, 2]
        assert (depth[view] > 0).sum() == len(view_points)
        np.testing.assert_allclose(depth[view][depth[view] > 0], z, rtol=1e-5)  # row by row
