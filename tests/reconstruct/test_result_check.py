"""A ball is told from a part."""

import numpy as np
import pytest

from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.reconstruct.result_check import (
    ResultShares,
    covered_share,
    no_part_warning,
    result_shares,
)
from industnerf.reconstruct.silhouette_check import silhouettes_of
from tests.methods.industnerf.synthetic_scenes import ball, orbit_cameras, render_images

CENTER, RADIUS = np.array([300.0, -20.0, 5.0]), 40.0


@pytest.mark.parametrize(("relative_radius", "is_ball"), [(1.0, True), (0.98, True), (0.9, False)])
def test_the_rim_of_the_region_is_no_part(relative_radius, is_ball):
    points = CENTER + relative_radius * RADIUS * fibonacci_sphere(500)
    shares = result_shares(points, np.zeros(500, np.int16), CENTER, RADIUS)
    assert shares == ResultShares(float(is_ball), 0.0)
    assert shares.is_ball is is_ball


@pytest.mark.parametrize(
    ("rim", "unseen", "is_ball"),
    [(0.67, 0.45, True), (0.30, 0.19, False), (0.2, 0.45, True), (0.67, 0.0, True)],
)
def test_what_was_measured_is_told(rim, unseen, is_ball):
    """The fox of instant-ngp with its surroundings, and a part that was photographed well."""
    points = np.tile(CENTER, (1000, 1))
    points[: round(1000 * rim), 0] += RADIUS
    view = np.zeros(1000, np.int16)
    view[: round(1000 * unseen)] = -1
    shares = result_shares(points, view, CENTER, RADIUS)
    assert (shares.is_ball, shares.is_no_part) == (is_ball, is_ball)
    if not is_ball:
        return
    warning = no_part_warning(shares)
    assert f"{rim:.0%} of its points lie beyond 0.97" in warning
    assert f"{unseen:.0%} are seen by no photograph" in warning


def patterned(images, kept):
    """The first `kept` of them as they are, the others before tiles of many colors."""
    rng = np.random.default_rng(0)
    tiles = rng.integers(0, 256, (len(images), 8, 8, 3), np.uint8).repeat(12, 1).repeat(12, 2)
    is_background = (images == images[0, 0, 0]).all(axis=-1, keepdims=True)
    is_background[:kept] = False
    return np.where(is_background, tiles[:, : images.shape[1], : images.shape[2]], images)


@pytest.mark.parametrize(("kept", "is_no_part"), [(8, False), (5, False), (3, True), (0, True)])
def test_a_result_covers_what_differs_from_the_background_in_most_photographs(kept, is_no_part):
    """Of eight photographs of a ball, `kept` of them before white: the result is the ball."""
    cameras = orbit_cameras(8, 96)
    images = render_images(ball(18.0), cameras)
    white = np.tile(images[0, 0, 0] / 255, (8, 1))
    silhouettes = silhouettes_of(np.arange(8), patterned(images, kept), cameras, white)
    rendered = silhouettes_of(np.arange(8), images, cameras, white)
    np.testing.assert_array_equal(silhouettes.views, rendered.views)
    covered = covered_share(silhouettes, rendered.masks)
    shares = ResultShares(0.2, 0.1, covered)
    assert shares.is_no_part is is_no_part
    assert not shares.is_ball
    if is_no_part:
        text = f"a piece of the scene and not the part: it covers {covered:.0%} of what differs"
        assert text in no_part_warning(shares)
    else:
        assert covered == 1.0
