"""The mean of what depth images say, against the same in plain loops; and what one does not say."""

import numpy as np
import pytest
import warp as wp

from industnerf.geometry import fusing, fusion
from industnerf.geometry.cameras import projections_from_ball
from industnerf.geometry.cellwise import told
from industnerf.geometry.compiled import where
from tests.methods.solids import cameras_around

CAMERAS = cameras_around(5, 192, 30.0)
AHEAD = np.eye(3, 4, dtype=np.float32)  # from the origin: u = x / z, v = y / z
N, TRUNCATION = 16, 0.25
AT = (np.indices((N, N, N)) + 0.5) * 2 / N - 1
BEYOND = np.linalg.norm(AT, axis=0) > 1  # the ball
BUMPY = np.random.default_rng(0).uniform(3.4, 4.6, (5, 48, 48)).astype(np.float32)
BUMPY[:, ::5] = 0  # background, as much of it as images show
BUMPY[:, :, 7] = fusion.UNKNOWN


def seen() -> np.ndarray:
    """Projections of the cameras to images of a quarter of their size."""
    projections = projections_from_ball(CAMERAS, np.zeros(3), 30.0)
    return projections * np.float32([[0.25], [0.25], [1]])


def fused_slowly(depth: np.ndarray, projections: np.ndarray) -> np.ndarray:
    """Cell by cell and image by image."""
    images = fusion.read(depth, projections)
    values, left = np.full((2, N, N, N), TRUNCATION)
    for cell in np.ndindex(N, N, N):
        total = weights = 0.0
        for known, nearest, cosine, projection in zip(*vars(images).values(), strict=True):
            u, v, z = projection @ [*AT[(slice(None), *cell)], 1]
            if z <= 0 or not (0 <= u / z < known.shape[1] and 0 <= v / z < known.shape[0]):
                continue
            pixel = int(v / z), int(u / z)
            if nearest[pixel] - z > TRUNCATION:
                left[cell] = 0
            if cosine[pixel] > 0:
                behind = (z - known[pixel]) * cosine[pixel]
                weight = cosine[pixel] * np.clip(2 - 4 * behind / TRUNCATION, 0, 1)
                total += weight * max(behind, -TRUNCATION)
                weights += weight
        values[cell] = total / weights if weights else TRUNCATION
    beside = np.pad(left > 0, 1)
    near = np.any([beside[tuple(slice(i, i + N) for i in s)] for s in np.ndindex(3, 3, 3)], axis=0)
    return np.where(near & ((left > 0) | (values < 0)) & ~BEYOND, values, -TRUNCATION)


def test_what_is_fused_is_what_plain_loops_say():
    """A cell that is projected to the border of a pixel may be rounded to either side."""
    found, slow = fusion.fuse(BUMPY, seen(), N, TRUNCATION), fused_slowly(BUMPY, seen())
    assert len(np.unique(slow)) > 500
    assert np.isclose(found, slow, rtol=0, atol=1e-5).mean() > 0.995


@pytest.mark.skipif(
    not wp.is_cuda_available(),
    reason="no CUDA device: that it fuses what the CPU does is untested",
)
def test_a_gpu_fuses_the_same(monkeypatch):
    found = []
    for device in ("cpu", "cuda"):
        monkeypatch.setenv("INDUSTNERF_DEVICE", device)
        assert where() == device
        found.append(fusion.fuse(BUMPY, seen(), N, TRUNCATION))
    assert np.isclose(*found, rtol=0, atol=1e-5).mean() > 0.995


def test_cells_behind_a_camera_are_in_no_image():
    """With a wide lens close by, much of the ball is behind cameras: none knows of it."""
    values = fusion.fuse(np.ones((1, 8, 8), np.float32), AHEAD[None], N, 0.125)
    assert (values[(AT[2] < 0) & ~BEYOND] == np.float32(0.125)).all()
    assert (values < 0).any()


def test_a_pixel_of_which_nothing_is_known_says_nothing():
    """Nor does one beside it, of what is empty: the part may reach into it."""
    depth = np.full((1, 3, 8), 0.75, np.float32)
    depth[0, 1, 4] = fusion.UNKNOWN
    aside = AHEAD + np.float32([[0, 0, 4, 0], [0, 0, 1, 0], [0, 0, 0, 0]])
    about = 64, 0.125, fusion.read(depth, aside[None]).compiled()
    x, y, z = (np.indices((64, 64, 64)).reshape(3, -1) + 0.5) / 32 - 1
    column, row = x // z + 4, y // z + 1
    before, at = (
        np.flatnonzero((row == 1) & (z > 0) & some).astype(np.int32)
        for some in (z < 0.6, np.abs(z - 0.74) < 0.01)
    )
    unseen = told(fusing.measure_unseen, before, *about) > 0
    assert unseen[np.isin(column[before], [3, 4, 5])].all()
    assert not unseen[np.isin(column[before], [0, 1, 2, 6, 7])].any()
    mean, unknown = told(fusing.measure_mean, at, *about), column[at] == 4
    assert (mean[unknown] == np.float32(0.125)).all()
    np.testing.assert_allclose(mean[~unknown], (z[at] - 0.75)[~unknown], rtol=0, atol=1e-6)
    assert 50 < unknown.sum() < len(at) - 50


def test_cells_beside_the_plane_of_a_camera_are_out_of_frame():
    """Their column, before it is bounded, is more than 32 bits hold."""
    close = AHEAD * np.float32([[1], [1], [1e-12]])
    values = fusion.fuse(np.ones((1, 8, 8), np.float32), close[None], N, 0.125)
    assert (values[~BEYOND] == np.float32(0.125)).all()


def test_images_that_show_nothing_say_nothing():
    values = fusion.fuse(np.zeros((2, 8, 8), np.float32), AHEAD[None].repeat(2, 0), N, 0.125)
    assert (values[~BEYOND] == np.float32(0.125)).all()


def test_beyond_the_ball_is_nothing_whether_a_view_looks_there_or_not():
    """Or few views would leave solid corners of the cube far from any part."""
    values = fusion.fuse(BUMPY, seen(), N, TRUNCATION)
    assert (values[BEYOND] == np.float32(-TRUNCATION)).all()


def test_a_slope_is_measured_on_the_flatter_side():
    depth = np.full((5, 7), fusion.STEEP)
    depth[:, 3:] = np.float32([2, 2.5, 3, 3.5])
    # 0.5 per column, nothing per row, also at the outline and at the border
    np.testing.assert_allclose(fusion.slopes(depth)[:, 3:], 0.5)


def test_the_focal_length_is_read_from_a_projection():
    projection = projections_from_ball(CAMERAS, np.array([1.0, 2, 3]), 17.0)
    for one in projection:
        assert fusion.focal_of(one) == pytest.approx(CAMERAS.K[0, 0, 0], rel=1e-5)  # float32
