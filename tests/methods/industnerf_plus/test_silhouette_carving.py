"""What is carved away was never part of the solid; what is plainly outside is carved away."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.geometry.silhouettes import (
    MAX_DISTANCE_PX,
    foreground_mask,
    silhouette_distances,
)
from industnerf.methods.industnerf.scene import NerfScene, PosedImages, make_scene
from tests.methods.industnerf.synthetic_scenes import (
    CENTER,
    CPU,
    SCENE_RADIUS,
    TOLERANCE,
    ball,
    box,
    make_posed_images,
    make_silhouettes,
    make_test_scene,
    orbit_cameras,
    render_images,
)
from tests.methods.solids import DISTANCE

SOLIDS = {"ball": ball(18.0), "box": box((16.0, 11.0, 8.0))}
SEEDS = st.integers(0, 2**32 - 1)


def random_points(seed: int, count: int = 4000) -> torch.Tensor:
    return torch.rand(count, 3, generator=torch.Generator().manual_seed(seed)) * 1.6 - 0.8


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize("resolution", [24, 64])
@pytest.mark.parametrize("margin", [0.0, 0.05])
def test_no_point_of_the_solid_is_carved_away(name, resolution, margin):
    silhouettes = make_silhouettes(make_test_scene(SOLIDS[name], 12, resolution))
    points = random_points(0, 20_000)
    inside = torch.from_numpy(SOLIDS[name].signed_distance(points.numpy() * SCENE_RADIUS) <= 0)
    assert inside.sum() > 500
    assert silhouettes.inside_hull(points, margin)[inside].all()


def test_nothing_near_the_solid_is_carved_away_where_pixels_are_not_square():
    """Of half the height: the focal length is twice as many pixels upwards as sideways."""
    cameras = orbit_cameras(12, 24)
    K = cameras.K * [[1], [2], [1]]
    flat = replace(cameras, K=K, height=48)
    solid, margin, points = SOLIDS["box"], 0.15, random_points(0, 20_000)
    views = PosedImages(render_images(solid, flat), flat, np.ones((12, 3)), CENTER, SCENE_RADIUS)
    is_near = torch.from_numpy(
        solid.signed_distance(points.numpy() * SCENE_RADIUS) <= margin * SCENE_RADIUS
    )
    assert make_silhouettes(make_scene(views, CPU)).inside_hull(points, margin)[is_near].all()


def test_outlines_are_those_of_the_images():
    """Found from the distances that are known, and from the pixels: the same bytes.

    The images' own end at MAX_DISTANCE_PX.
    """
    views = make_test_scene(SOLIDS["box"], 12, 64)
    mask = foreground_mask(views.images.numpy(), views.background.numpy(), TOLERANCE)
    outlines, end = make_silhouettes(views).outlines(), MAX_DISTANCE_PX - 0.5
    np.testing.assert_array_equal(np.clip(outlines, -end, end), silhouette_distances(mask))
    assert outlines.min() < -end - 5


@pytest.mark.skipif(
    not torch.cuda.is_available(),
    reason="no CUDA device: that it finds the distances that the CPU does is untested",
)
def test_a_gpu_finds_the_same_silhouettes():
    """Roots of the same whole numbers, up to their last digit."""
    images, points = make_posed_images(SOLIDS["box"], 12, 64), random_points(0)
    on_cpu, on_gpu = (
        make_silhouettes(make_scene(images, torch.device(on))) for on in ("cpu", "cuda")
    )
    np.testing.assert_allclose(on_gpu.outlines(), on_cpu.outlines(), rtol=0, atol=2e-6)
    difference = on_gpu.distance(points.cuda()).cpu() - on_cpu.distance(points)
    assert difference.abs().max() < 1e-4  # radii of the region of interest, where a pixel is 0.03


def cone_excess(points: np.ndarray, camera_centers: np.ndarray, radius: float) -> np.ndarray:
    """How far points are outside each view's cone about a ball at the origin, (view, point)."""
    axis = -camera_centers / np.linalg.norm(camera_centers, axis=1, keepdims=True)
    offsets = points - camera_centers[:, None]
    along = np.einsum("vni,vi->vn", offsets, axis)
    off_axis = np.linalg.norm(offsets - along[:, :, None] * axis[:, None], axis=2)
    half_angle = np.arcsin(radius / np.linalg.norm(camera_centers, axis=1))[:, None]
    return off_axis * np.cos(half_angle) - along * np.sin(half_angle)


@pytest.mark.parametrize("margin", [0.0, 0.1])
def test_a_ball_is_carved_to_its_cones(margin):
    """Outside some cone by more than margin and 3 px: gone.  Inside all: kept."""
    views = make_test_scene(ball(18.0), 12, 64)
    points = random_points(1)
    excess = cone_excess(
        points.numpy(), views.cameras.c2w[:, :3, 3].numpy(), 18.0 / SCENE_RADIUS
    ).max(axis=0)
    kept = make_silhouettes(views).inside_hull(points, margin).numpy()
    assert kept[excess < 0].all()
    # 1 px of grace; up to 1 px from the last pixel that has a share of the part to its outline,
    # and from the point to its own pixel's center; what is not taken to be deeper than it is
    # costs nothing, but one may be nearer the eye than the part: up to 0.8 of 4.1
    pixel = (DISTANCE + 0.8) / views.cameras.K[0, 0, 0].item()
    assert not kept[excess > (margin + 3 * pixel) * 1.1].any()
    assert (excess > (margin + 3 * pixel) * 1.1).sum() > 500


@given(SEEDS)
def test_more_slack_keeps_more(seed):
    silhouettes = make_silhouettes(make_test_scene(ball(18.0), 4, 24))
    points = random_points(seed, 300)
    kept = [silhouettes.inside_hull(points, margin) for margin in (0.0, 0.1, 0.3)]
    assert (kept[0] <= kept[1]).all()
    assert (kept[1] <= kept[2]).all()


@given(SEEDS)
def test_views_carve_alone_or_together(seed):
    whole, points = make_test_scene(ball(18.0), 4, 24), random_points(seed, 300)
    each = [make_silhouettes(whole[i : i + 1]).inside_hull(points, 0.05) for i in range(4)]
    assert torch.equal(
        make_silhouettes(whole).inside_hull(points, 0.05), torch.stack(each).all(dim=0)
    )


def test_what_a_view_does_not_see_it_cannot_carve():
    views = make_test_scene(ball(18.0), 1, 24)
    eye, forward = views.cameras.c2w[0, :3, 3], views.cameras.c2w[0, :3, 2]
    right = views.cameras.c2w[0, :3, 0]
    unseen = torch.stack([eye - forward, eye, 3 * right, -3 * right])  # behind, at it, beside
    assert make_silhouettes(views).inside_hull(unseen, 0.0).all()


@pytest.mark.parametrize(("off", "part"), [(TOLERANCE / 2, False), (TOLERANCE * 2, True)])
def test_background_is_what_is_near_its_color_in_all_channels(off, part):
    """A white image with one darker channel in its middle; at its border lies the part."""
    views = make_test_scene(ball(18.0), 1, 24)
    image = torch.full_like(views.images, 255)
    image[0, 12, 12, 1] -= round(255 * off)
    image[0, 0, 0] = 0
    middle = torch.zeros(1, 3)  # 17 px from the corner
    kept = make_silhouettes(NerfScene(image, views.cameras, views.background)).inside_hull(
        middle, 0.0
    )
    assert kept.item() == part


def test_before_nothing_but_background_all_is_carved_away():
    views = make_test_scene(ball(18.0), 2, 24)
    blank = NerfScene(torch.full_like(views.images, 255), views.cameras, views.background)
    assert not make_silhouettes(blank).inside_hull(random_points(0, 100), 0.05).any()


def test_the_distance_of_a_ball_is_that_of_its_cones():
    """At a point's depth a pixel of the silhouette is `pixel` wide.

    A pixel counts as the part's if any of it is, so that outlines are up to a pixel outside the
    part, half a pixel in the mean, and interpolated within 0.7 of a pixel.  The picture plane is
    slanted against the way to a cone by up to 15 degrees, which makes lengths 4 % longer, and
    points are up to a fifth nearer or farther than the center.
    """
    views = make_test_scene(ball(18.0), 12, 64)
    points = random_points(3)
    excess = cone_excess(
        points.numpy(), views.cameras.c2w[:, :3, 3].numpy(), 18.0 / SCENE_RADIUS
    ).max(axis=0)
    actual = make_silhouettes(views).distance(points).numpy()
    pixel = (DISTANCE + 0.8) / views.cameras.K[0, 0, 0].item()
    is_near = np.abs(excess) < 0.3
    assert is_near.sum() > 1000
    assert np.abs(actual - excess)[is_near].max() < 1.2 * pixel + 0.06 * 0.3
    assert -0.7 * pixel < np.mean((actual - excess)[is_near]) < 0.1 * pixel


def test_views_that_do_not_have_a_point_in_frame_say_nothing_of_its_distance():
    views = make_test_scene(ball(18.0), 12, 64)
    far = torch.tensor([[0.0, 0.0, 50.0]])
    assert make_silhouettes(views).distance(far).isfinite().all()
