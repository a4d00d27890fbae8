"""What is in frame, and what is one direction."""

import numpy as np
import pytest

from industnerf.geometry.cameras import Cameras
from industnerf.reconstruct.region import axis_spread, in_frame
from tests.reconstruct import sample_images

CAMERAS = sample_images.cameras()


def test_axes_spread_by_the_sine_of_half_the_angle_between_two():
    """The direction nearest to both is between them, and their lines have no sign."""
    for angle in (0.0, 0.3, np.pi / 2):
        c2w = np.tile(np.eye(4), (2, 1, 1))
        c2w[1, :3, 2] = -np.array([np.sin(angle), 0, np.cos(angle)])
        two = Cameras(CAMERAS.K[:2], c2w, sample_images.WIDTH, sample_images.HEIGHT)
        assert axis_spread(two) == pytest.approx(np.sin(angle / 2), abs=1e-7)  # a root of rounding


def test_frames_end_at_their_edges():
    """A camera at the origin that looks along +z, with edges at known slopes."""
    (fx, _, cx), (_, fy, cy), _ = CAMERAS.K[0]
    one = Cameras(CAMERAS.K[:1], np.eye(4)[None], sample_images.WIDTH, sample_images.HEIGHT)
    for point, is_inside in [
        ([0, 0, 1], True),
        ([0, 0, -1], False),
        ([-cx / fx + 1e-6, 0, 1], True),
        ([-cx / fx - 1e-6, 0, 1], False),
        ([(sample_images.WIDTH - cx) / fx + 1e-6, 0, 1], False),
        ([0, (sample_images.HEIGHT - cy) / fy - 1e-6, 1], True),
        ([0, (sample_images.HEIGHT - cy) / fy + 1e-6, 1], False),
        ([0, -cy / fy - 1e-6, 1], False),
    ]:
        assert in_frame(one, np.array(point, float)).tolist() == [is_inside], point
