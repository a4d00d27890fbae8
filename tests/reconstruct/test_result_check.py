"""A ball is told from a part."""

import numpy as np
import pytest

from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.reconstruct.result_check import RegionShares, ball_warning, region_shares

CENTER, RADIUS = np.array([300.0, -20.0, 5.0]), 40.0


@pytest.mark.parametrize(("relative_radius", "is_ball"), [(1.0, True), (0.98, True), (0.9, False)])
def test_the_rim_of_the_region_is_no_part(relative_radius, is_ball):
    points = CENTER + relative_radius * RADIUS * fibonacci_sphere(500)
    shares = region_shares(points, np.zeros(500, np.int16), CENTER, RADIUS)
    assert shares == RegionShares(float(is_ball), 0.0)
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
    shares = region_shares(points, view, CENTER, RADIUS)
    assert shares.is_ball is is_ball
    warning = ball_warning(shares)
    assert f"{rim:.0%} of its points lie beyond 0.97" in warning
    assert f"{unseen:.0%} are seen by no photograph" in warning
