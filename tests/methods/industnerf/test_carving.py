"""What is carved away was never part of the solid; what is plainly outside is carved away."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.geometry.silhouettes import outlines, part_in
from industnerf.methods.industnerf.scene import Posed, Scene, scene_of
from tests.methods.industnerf.scenes import (
    CENTRE,
    CPU,
    REACH,
    TOLERANCE,
    around,
    ball,
    box,
    photographs,
    posed,
    scene,
    silhouettes_of,
)
from tests.methods.solids import AWAY

SOLIDS = {"ball": ball(18.0), "box": box((16.0, 11.0, 8.0))}
SEEDS = st.integers(0, 2**32 - 1)


def places(seed: int, count: int = 4000) -> torch.Tensor:
    return torch.rand(count, 3, generator=torch.Generator().manual_seed(seed)) * 1.6 - 0.8


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize("resolution", [24, 64])
@pytest.mark.parametrize("slack", [0.0, 0.05])
def test_no_point_of_the_solid_is_carved_away(name, resolution, slack):
    silhouettes = silhouettes_of(scene(SOLIDS[name], 12, resolution))
    points = places(0, 20_000)
    inside = torch.from_numpy(SOLIDS[name].away(points.numpy() * REACH) <= 0)
    assert inside.sum() > 500
    assert silhouettes.may_hold(points, slack)[inside].all()


def test_nothing_near_the_solid_is_carved_away_where_pixels_are_not_square():
    """Of half the height: the focal length is twice as many pixels upwards as sideways."""
    cameras = around(12, 24)
    K = cameras.K * [[1], [2], [1]]
    flat = replace(cameras, K=K, height=48)
    solid, slack, points = SOLIDS["box"], 0.15, places(0, 20_000)
    seen = Posed(photographs(solid, flat), flat, np.ones((12, 3)), CENTRE, REACH)
    near = torch.from_numpy(solid.away(points.numpy() * REACH) <= slack * REACH)
    assert silhouettes_of(scene_of(seen, CPU)).may_hold(points, slack)[near].all()


def test_outlines_are_those_of_the_images():
    """Found from the distances that are known, and from the pixels: the same bytes."""
    seen = scene(SOLIDS["box"], 12, 64)
    part = part_in(seen.images.numpy(), seen.background.numpy(), TOLERANCE)
    np.testing.assert_array_equal(silhouettes_of(seen).outlines(), outlines(part))


@pytest.mark.skipif(
    not torch.cuda.is_available(),
    reason="no CUDA device: that it finds the distances that the CPU does is untested",
)
def test_a_gpu_finds_the_same_silhouettes():
    """Roots of the same whole numbers, up to their last digit."""
    given, points = posed(SOLIDS["box"], 12, 64), places(0)
    here, there = (silhouettes_of(scene_of(given, torch.device(on))) for on in ("cpu", "cuda"))
    np.testing.assert_allclose(there.outlines(), here.outlines(), rtol=0, atol=2e-6)
    off = there.distance(points.cuda()).cpu() - here.distance(points)
    assert off.abs().max() < 1e-4  # radii of the region of interest, where a pixel is 0.03


def cone_excess(points: np.ndarray, eyes: np.ndarray, radius: float) -> np.ndarray:
    """How far points are outside each view's cone about a ball at the origin, (view, point)."""
    axis = -eyes / np.linalg.norm(eyes, axis=1, keepdims=True)
    to = points - eyes[:, None]
    along = np.einsum("vni,vi->vn", to, axis)
    beside = np.linalg.norm(to - along[:, :, None] * axis[:, None], axis=2)
    half = np.arcsin(radius / np.linalg.norm(eyes, axis=1))[:, None]
    return beside * np.cos(half) - along * np.sin(half)


@pytest.mark.parametrize("slack", [0.0, 0.1])
def test_a_ball_is_carved_to_its_cones(slack):
    """Outside some cone by more than slack and 3 px: gone.  Inside all: kept."""
    seen = scene(ball(18.0), 12, 64)
    points = places(1)
    excess = cone_excess(points.numpy(), seen.eyes.c2w[:, :3, 3].numpy(), 18.0 / REACH).max(axis=0)
    kept = silhouettes_of(seen).may_hold(points, slack).numpy()
    assert kept[excess < 0].all()
    # 1 px of grace; up to 1 px from the last pixel that has a share of the part to its outline,
    # and from the point to its own pixel's centre; what is not taken to be deeper than it is
    # costs nothing, but one may be nearer the eye than the part: up to 0.8 of 4.1
    pixel = (AWAY + 0.8) / seen.eyes.K[0, 0, 0].item()
    assert not kept[excess > (slack + 3 * pixel) * 1.1].any()
    assert (excess > (slack + 3 * pixel) * 1.1).sum() > 500


@given(SEEDS)
def test_more_slack_keeps_more(seed):
    silhouettes, points = silhouettes_of(scene(ball(18.0), 4, 24)), places(seed, 300)
    kept = [silhouettes.may_hold(points, slack) for slack in (0.0, 0.1, 0.3)]
    assert (kept[0] <= kept[1]).all()
    assert (kept[1] <= kept[2]).all()


@given(SEEDS)
def test_views_carve_alone_or_together(seed):
    whole, points = scene(ball(18.0), 4, 24), places(seed, 300)
    each = [silhouettes_of(whole[i : i + 1]).may_hold(points, 0.05) for i in range(4)]
    assert torch.equal(silhouettes_of(whole).may_hold(points, 0.05), torch.stack(each).all(dim=0))


def test_what_a_view_does_not_see_it_cannot_carve():
    seen = scene(ball(18.0), 1, 24)
    eye, ahead = seen.eyes.c2w[0, :3, 3], seen.eyes.c2w[0, :3, 2]
    right = seen.eyes.c2w[0, :3, 0]
    elsewhere = torch.stack([eye - ahead, eye, 3 * right, -3 * right])  # behind, at it, beside
    assert silhouettes_of(seen).may_hold(elsewhere, 0.0).all()


@pytest.mark.parametrize(("off", "part"), [(TOLERANCE / 2, False), (TOLERANCE * 2, True)])
def test_background_is_what_is_near_its_colour_in_all_channels(off, part):
    """A white image with one darker channel in its middle; at its border lies the part."""
    seen = scene(ball(18.0), 1, 24)
    image = torch.full_like(seen.images, 255)
    image[0, 12, 12, 1] -= round(255 * off)
    image[0, 0, 0] = 0
    middle = torch.zeros(1, 3)  # 17 px from the corner
    kept = silhouettes_of(Scene(image, seen.eyes, seen.background)).may_hold(middle, 0.0)
    assert kept.item() == part


def test_before_nothing_but_background_all_is_carved_away():
    seen = scene(ball(18.0), 2, 24)
    blank = Scene(torch.full_like(seen.images, 255), seen.eyes, seen.background)
    assert not silhouettes_of(blank).may_hold(places(0, 100), 0.05).any()


def test_the_distance_of_a_ball_is_that_of_its_cones():
    """At a point's depth a pixel of the silhouette is `pixel` wide.

    A pixel counts as the part's if any of it is, so that outlines are up to a pixel outside the
    part, half a pixel in the mean, and interpolated within 0.7 of a pixel.  The picture plane is
    slanted against the way to a cone by up to 15 degrees, which makes lengths 4 % longer, and
    points are up to a fifth nearer or farther than the centre.
    """
    seen = scene(ball(18.0), 12, 64)
    points = places(3)
    excess = cone_excess(points.numpy(), seen.eyes.c2w[:, :3, 3].numpy(), 18.0 / REACH).max(axis=0)
    found = silhouettes_of(seen).distance(points).numpy()
    pixel = (AWAY + 0.8) / seen.eyes.K[0, 0, 0].item()
    near = np.abs(excess) < 0.3
    assert near.sum() > 1000
    assert np.abs(found - excess)[near].max() < 1.2 * pixel + 0.06 * 0.3
    assert -0.7 * pixel < np.mean((found - excess)[near]) < 0.1 * pixel


def test_views_that_do_not_have_a_point_in_frame_say_nothing_of_its_distance():
    seen = scene(ball(18.0), 12, 64)
    far = torch.tensor([[0.0, 0.0, 50.0]])
    assert silhouettes_of(seen).distance(far).isfinite().all()
