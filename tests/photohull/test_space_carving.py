"""The r-consistency of a cell, against the same rule in plain loops."""

import numpy as np
import pytest
import warp as wp

from industnerf.config import load_params
from industnerf.geometry.silhouettes import silhouette_distances
from industnerf.geometry.warp_launch import warp_device
from industnerf.photohull import kernels
from industnerf.photohull.space_carving import SpaceCarver, color_ranges, surface_voxels
from industnerf.photohull.voxel_grid import depth_in_hull, unit_frame_cameras_about
from industnerf.schema import SpaceCarvingSettings
from tests.methods.solids import cameras_around, masks_of_ball

N, PX, REACH = 16, 96, 30.0
CAMERAS = cameras_around(24, PX, REACH)
RIG = unit_frame_cameras_about(CAMERAS, np.zeros(3), REACH)
RGB = np.random.default_rng(0).integers(0, 256, (24, PX, PX, 3), np.uint8)
AT = (np.indices((N, N, N)) + 0.5) * 2 / N - 1
MASKS = masks_of_ball(20.0, CAMERAS)
# A ball with a bite taken out of it: some of its surface is hidden by the rest.
SOLID = (np.linalg.norm(AT, axis=0) < 0.8) & (np.linalg.norm(AT - 0.5, axis=0) > 0.5)


def settings_with(**changed: float) -> SpaceCarvingSettings:
    start = load_params().method.industnerf_plus.sdf.init
    known = {name: getattr(start, name) for name in SpaceCarvingSettings.__dataclass_fields__}
    return SpaceCarvingSettings(**(known | {"min_view_cosine": 0.2} | changed))


def color_gaps(settings: SpaceCarvingSettings) -> tuple[np.ndarray, np.ndarray]:
    """The compiled gap of every surface cell, and the cells."""
    sweeper = SpaceCarver(SOLID, RGB, RIG, settings)
    cells = surface_voxels(SOLID.astype(np.uint8))
    return cells, sweeper.color_gaps(cells)


def slow_color_gap(cell: int, settings: SpaceCarvingSettings) -> float:
    """How far the colors of the views are apart that see the cell; UNKNOWN of too few."""
    index = np.array(np.unravel_index(cell, SOLID.shape))
    x = (index + 0.5) * 2 / N - 1
    patch = np.argwhere(SOLID) - index
    normal = -patch[np.abs(patch).max(axis=1) <= 2].sum(axis=0)
    width = max(1, round(settings.voxel_footprint * RIG.min_diameter_px / N))
    darkest, brightest = color_ranges(RGB, width)
    low, high = [], []
    for view, (projection, camera_center) in enumerate(
        zip(RIG.projection, RIG.camera_centers, strict=True)
    ):
        view_direction = (camera_center - x) / np.linalg.norm(camera_center - x)
        if view_direction @ normal <= settings.min_view_cosine * np.linalg.norm(
            normal
        ) or is_occluded(x, view_direction):
            continue
        u, v, depth = projection @ [*x, 1]
        low.append(darkest[view, int(v / depth), int(u / depth)].astype(int))
        high.append(brightest[view, int(v / depth), int(u / depth)].astype(int))
    if len(low) < settings.min_views:
        return float(kernels.UNKNOWN)
    drop = min(int(settings.outlier_fraction * len(low)), 3)
    apart = np.sort(low, axis=0)[-1 - drop] - np.sort(high, axis=0)[drop]
    return apart.max() / 255


def is_occluded(x: np.ndarray, towards: np.ndarray) -> bool:
    """Whether the solid is in the way, from two cells on."""
    for step in range(2, 4 * N):
        there = np.floor((x + step * 2 / N * towards + 1) * N / 2).astype(int)
        if ((there < 0) | (there >= N)).any():
            return False
        if SOLID[tuple(there)]:
            return True
    return False


@pytest.mark.parametrize("outliers", [0.0, 0.2, 0.4])
def test_the_gap_is_that_of_plain_loops(outliers):
    """A ray that grazes a cell may be rounded to either side: at most one cell in a hundred."""
    settings = settings_with(outlier_fraction=outliers)
    cells, result = color_gaps(settings)
    slow = np.array([slow_color_gap(int(cell), settings) for cell in cells])
    assert len(cells) > 300
    assert np.isclose(result, slow, rtol=0, atol=1e-6).mean() > 0.99


def test_fewer_views_than_asked_for_say_nothing():
    assert (color_gaps(settings_with(min_views=25))[1] == np.float32(kernels.UNKNOWN)).all()


@pytest.mark.skipif(
    not wp.is_cuda_available(),
    reason="no CUDA device: that it carves what the CPU does is untested",
)
def test_a_gpu_measures_and_takes_off_the_same(monkeypatch):
    """Up to rays that graze a cell: rounded otherwise, they hide it or do not."""
    result = {}
    for device in ("cpu", "cuda"):
        monkeypatch.setenv("INDUSTNERF_DEVICE", device)
        assert warp_device() == device
        left = SpaceCarver(
            SOLID, RGB, RIG, settings_with(color_threshold=0.3, voxel_footprint=0.1)
        ).carve(4)
        result[device] = (
            depth_in_hull(silhouette_distances(MASKS), RIG, 32),
            color_gaps(settings_with())[1],
            left,
        )
    here, there = result.values()
    assert (here[1] > kernels.UNKNOWN).mean() > 0.5
    assert here[2].sum() < 0.9 * SOLID.sum()
    np.testing.assert_allclose(there[0], here[0], rtol=0, atol=1e-3)
    assert np.isclose(there[1], here[1], rtol=0, atol=1e-6).mean() > 0.99
    assert (there[2] != here[2]).sum() < 0.01 * SOLID.sum()


@pytest.mark.parametrize("threshold", [0.1, 0.3, 0.6])
def test_what_contradicts_itself_more_than_the_threshold_goes(threshold):
    """Noise differs by nearly everything from one view to the next."""
    sweeper = SpaceCarver(
        SOLID,
        RGB,
        RIG,
        settings_with(color_threshold=threshold, voxel_footprint=0.1, outlier_fraction=0.0),
    )
    assert sweeper.carve(4).sum() < 0.7 * SOLID.sum()
