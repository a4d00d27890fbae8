"""Bent lenses: OpenCV's formulas at points worked out by hand, and a photograph of a known wall."""

import numpy as np
import pytest

from industnerf.errors import BadArtifact
from industnerf.reconstruct.distortion import Distortion, undistort

W, H = 160, 120
K = np.array([[150.0, 0, 82.0], [0, 155.0, 58.0], [0, 0, 1]])
BARREL = Distortion(k1=-0.2, k2=0.05, k3=-0.01, p1=2e-3, p2=-3e-3)
PINCUSHION = Distortion(k1=0.15, p1=-1e-3)


@pytest.mark.parametrize(
    ("lens", "ray", "distorted"),
    [  # each coefficient alone, with r^2 = 0.25: x = 0.3, y = 0.4
        (Distortion(k1=1.0), (0.3, 0.4), (0.375, 0.5)),
        (Distortion(k2=1.0), (0.3, 0.4), (0.31875, 0.425)),
        (Distortion(k3=1.0), (0.3, 0.4), (0.3046875, 0.40625)),
        (Distortion(p1=1.0), (0.3, 0.4), (0.54, 0.97)),  # + (2 x y, r^2 + 2 y^2)
        (Distortion(p2=1.0), (0.3, 0.4), (0.73, 0.64)),  # + (r^2 + 2 x^2, 2 x y)
    ],
)
def test_a_ray_is_bent_as_opencv_says(lens, ray, distorted):
    np.testing.assert_allclose(lens.distort(np.array(ray)), distorted, rtol=1e-14)


def wall_colors(rays: np.ndarray) -> np.ndarray:
    """Colors of a wall that is met by the rays (x, y, 1): slow waves, as a photograph has them."""
    x, y = rays[..., 0], rays[..., 1]
    waves = [np.sin(9 * x + 1), np.cos(7 * y), np.sin(6 * x - 8 * y)]
    return np.stack([127.5 + 120 * wave for wave in waves], axis=-1)


def pixel_rays(K: np.ndarray) -> np.ndarray:
    column, row = np.meshgrid(np.arange(W) + 0.5, np.arange(H) + 0.5)
    px = np.stack([column, row], axis=-1)
    return (px - K[:2, 2]) / K[[0, 1], [0, 1]]


def invert_distortion(distorted: np.ndarray, distortion: Distortion) -> np.ndarray:
    """The rays that are bent to `met`, by Newton's method with differences for a slope."""
    rays, step = distorted.copy(), 1e-6
    for _ in range(20):
        residual = distortion.distort(rays) - distorted
        jacobian = np.stack(
            [
                (distortion.distort(rays + direction) - distortion.distort(rays - direction))
                / (2 * step)
                for direction in step * np.eye(2)
            ],
            axis=-1,
        )
        rays -= np.linalg.solve(jacobian, residual[..., None])[..., 0]
    np.testing.assert_allclose(distortion.distort(rays), distorted, atol=1e-9)
    return rays


@pytest.mark.parametrize("lens", [BARREL, PINCUSHION])
def test_a_photograph_of_a_wall_becomes_what_a_pinhole_sees(lens):
    image = np.rint(wall_colors(invert_distortion(pixel_rays(K), lens))).astype(np.uint8)
    undistorted, pinhole_K = undistort(image, K, lens, "frame 0")
    # 0.5 for each rounding; waves of 10 rad a unit bend by 120 * (10 / 150)^2 / 8 within a pixel
    error = np.abs(undistorted - wall_colors(pixel_rays(pinhole_K)))
    assert error.max() < 1.5
    distorted_error = np.abs(image - wall_colors(pixel_rays(K)))
    assert (
        distorted_error.max() > 10
    )  # it was bent: the test would see a photograph that is left alone


@pytest.mark.parametrize("lens", [BARREL, PINCUSHION])
def test_no_pixel_is_missing_and_none_more_than_needed_is_lost(lens):
    _, pinhole_K = undistort(np.zeros((H, W, 3), np.uint8), K, lens, "frame 0")
    assert pinhole_K[:2, 2].tolist() == K[:2, 2].tolist()
    column, row = np.meshgrid(np.linspace(0, W, 201), np.linspace(0, H, 201))
    rays = (np.stack([column, row], axis=-1) - K[:2, 2]) / pinhole_K[[0, 1], [0, 1]]
    px = K[:2, 2] + K[[0, 1], [0, 1]] * lens.distort(rays)
    overflow_px = np.maximum(-px, px - [W, H]).max()
    assert -0.1 < overflow_px < 0.01  # px; sides are asked at 65 points


def test_no_bend_changes_nothing():
    image = np.random.default_rng(0).integers(0, 256, (H, W, 3), np.uint8)
    undistorted, pinhole_K = undistort(image, K, Distortion(), "frame 0")
    np.testing.assert_allclose(pinhole_K, K, rtol=1e-6)
    assert np.abs(undistorted.astype(int) - image).max() <= 1  # a zoom of 1 + 1e-7, rounded


def test_a_lens_that_folds_the_image_is_refused():
    with pytest.raises(BadArtifact, match=r"frame 0: .*k1=-40.* cannot be undone"):
        undistort(np.zeros((H, W, 3), np.uint8), K, Distortion(k1=-40.0), "frame 0")
