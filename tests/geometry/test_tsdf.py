"""The mean of what depth images say, against the same in plain loops; and what one does not say."""

import numpy as np
import pytest
import warp as wp

from industnerf.geometry import tsdf, tsdf_kernels
from industnerf.geometry.cameras import unit_ball_projections
from industnerf.geometry.warp_launch import launch, warp_device
from tests.methods.solids import cameras_around

CAMERAS = cameras_around(5, 192, 30.0)
IDENTITY_PROJECTION = np.eye(3, 4, dtype=np.float32)  # from the origin: u = x / z, v = y / z
N, TRUNCATION = 16, 0.25
AT = (np.indices((N, N, N)) + 0.5) * 2 / N - 1
OUTSIDE_BALL = np.linalg.norm(AT, axis=0) > 1  # the ball
BUMPY = np.random.default_rng(0).uniform(3.4, 4.6, (5, 48, 48)).astype(np.float32)
BUMPY[:, ::5] = 0  # background, as much of it as images show
BUMPY[:, :, 7] = tsdf.UNKNOWN


def surface_seen() -> np.ndarray:
    """Projections of the cameras to images of a quarter of their size."""
    projections = unit_ball_projections(CAMERAS, np.zeros(3), 30.0)
    return projections * np.float32([[0.25], [0.25], [1]])


def fused_slowly(depth: np.ndarray, projections: np.ndarray) -> np.ndarray:
    """Cell by cell and image by image."""
    images = tsdf.prepare_depth_images(depth, projections)
    values, is_unseen = np.full((2, N, N, N), TRUNCATION)
    for cell in np.ndindex(N, N, N):
        total = weights = 0.0
        for known, nearest, cosine, projection in zip(*vars(images).values(), strict=True):
            u, v, z = projection @ [*AT[(slice(None), *cell)], 1]
            if z <= 0 or not (0 <= u / z < known.shape[1] and 0 <= v / z < known.shape[0]):
                continue
            pixel = int(v / z), int(u / z)
            if nearest[pixel] - z > TRUNCATION:
                is_unseen[cell] = 0
            if cosine[pixel] > 0:
                behind = (z - known[pixel]) * cosine[pixel]
                weight = cosine[pixel] * np.clip(2 - 4 * behind / TRUNCATION, 0, 1)
                total += weight * max(behind, -TRUNCATION)
                weights += weight
        values[cell] = total / weights if weights else TRUNCATION
    padded = np.pad(is_unseen > 0, 1)
    is_near = np.any(
        [padded[tuple(slice(i, i + N) for i in s)] for s in np.ndindex(3, 3, 3)], axis=0
    )
    return np.where(is_near & ((is_unseen > 0) | (values < 0)) & ~OUTSIDE_BALL, values, -TRUNCATION)


def test_what_is_fused_is_what_plain_loops_say():
    """A cell that is projected to the border of a pixel may be rounded to either side."""
    result = tsdf.fuse(BUMPY, surface_seen(), N, TRUNCATION)
    slow = fused_slowly(BUMPY, surface_seen())
    assert len(np.unique(slow)) > 500
    assert np.isclose(result, slow, rtol=0, atol=1e-5).mean() > 0.995


@pytest.mark.skipif(
    not wp.is_cuda_available(),
    reason="no CUDA device: that it fuses what the CPU does is untested",
)
def test_a_gpu_fuses_the_same(monkeypatch):
    result = []
    for device in ("cpu", "cuda"):
        monkeypatch.setenv("INDUSTNERF_DEVICE", device)
        assert warp_device() == device
        result.append(tsdf.fuse(BUMPY, surface_seen(), N, TRUNCATION))
    assert np.isclose(*result, rtol=0, atol=1e-5).mean() > 0.995


def test_cells_behind_a_camera_are_in_no_image():
    """With a wide lens close by, much of the ball is behind cameras: none knows of it."""
    values = tsdf.fuse(np.ones((1, 8, 8), np.float32), IDENTITY_PROJECTION[None], N, 0.125)
    assert (values[(AT[2] < 0) & ~OUTSIDE_BALL] == np.float32(0.125)).all()
    assert (values < 0).any()


def test_a_pixel_of_which_nothing_is_known_says_nothing():
    """Nor does one beside it, of what is empty: the part may reach into it."""
    depth = np.full((1, 3, 8), 0.75, np.float32)
    depth[0, 1, 4] = tsdf.UNKNOWN
    neighbor = IDENTITY_PROJECTION + np.float32([[0, 0, 4, 0], [0, 0, 1, 0], [0, 0, 0, 0]])
    args = 64, 0.125, tsdf.prepare_depth_images(depth, neighbor[None]).to_kernel_struct()
    x, y, z = (np.indices((64, 64, 64)).reshape(3, -1) + 0.5) / 32 - 1
    column, row = x // z + 4, y // z + 1
    in_front, at = (
        np.flatnonzero((row == 1) & (z > 0) & some).astype(np.int32)
        for some in (z < 0.6, np.abs(z - 0.74) < 0.01)
    )
    unseen = launch(tsdf_kernels.measure_unseen, in_front, *args) > 0
    assert unseen[np.isin(column[in_front], [3, 4, 5])].all()
    assert not unseen[np.isin(column[in_front], [0, 1, 2, 6, 7])].any()
    mean, unknown = launch(tsdf_kernels.measure_mean, at, *args), column[at] == 4
    assert (mean[unknown] == np.float32(0.125)).all()
    np.testing.assert_allclose(mean[~unknown], (z[at] - 0.75)[~unknown], rtol=0, atol=1e-6)
    assert 50 < unknown.sum() < len(at) - 50


def test_cells_beside_the_plane_of_a_camera_are_out_of_frame():
    """Their column, before it is bounded, is more than 32 bits hold."""
    close = IDENTITY_PROJECTION * np.float32([[1], [1], [1e-12]])
    values = tsdf.fuse(np.ones((1, 8, 8), np.float32), close[None], N, 0.125)
    assert (values[~OUTSIDE_BALL] == np.float32(0.125)).all()


def test_images_that_show_nothing_say_nothing():
    values = tsdf.fuse(
        np.zeros((2, 8, 8), np.float32), IDENTITY_PROJECTION[None].repeat(2, 0), N, 0.125
    )
    assert (values[~OUTSIDE_BALL] == np.float32(0.125)).all()


def test_beyond_the_ball_is_nothing_whether_a_view_looks_there_or_not():
    """Or few views would leave solid corners of the cube far from any part."""
    values = tsdf.fuse(BUMPY, surface_seen(), N, TRUNCATION)
    assert (values[OUTSIDE_BALL] == np.float32(-TRUNCATION)).all()


def test_a_slope_is_measured_on_the_flatter_side():
    depth = np.full((5, 7), tsdf.BACKGROUND_DEPTH)
    depth[:, 3:] = np.float32([2, 2.5, 3, 3.5])
    # 0.5 per column, nothing per row, also at the outline and at the border
    np.testing.assert_allclose(tsdf.depth_slopes(depth)[:, 3:], 0.5)


def test_the_focal_length_is_read_from_a_projection():
    projection = unit_ball_projections(CAMERAS, np.array([1.0, 2, 3]), 17.0)
    for one in projection:
        assert tsdf.focal_length(one) == pytest.approx(CAMERAS.K[0, 0, 0], rel=1e-5)  # float32
