"""Projection in torch is that of `geometry.cameras`, and features are where the image is."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch.nn.functional import avg_pool2d

from industnerf.geometry import cameras
from industnerf.methods.industnerf.projection import (
    is_in_view,
    project,
    sample_features,
    world_to_camera,
)

SEEDS = st.integers(0, 2**32 - 1)
K = np.array([[600.0, 3, 320], [0, 610, 235], [0, 0, 1]])
WIDTH, HEIGHT = 24, 16


def random_pose(rng: np.random.Generator) -> np.ndarray:
    rotation, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    c2w = np.eye(4)
    c2w[:3, :3] = rotation * np.sign(np.linalg.det(rotation))
    c2w[:3, 3] = rng.uniform(-5, 5, 3)
    return c2w


def uv_within(count: int, margin: float) -> torch.Tensor:
    """Places of a 24 x 16 image at least `margin` px from its border."""
    rng = np.random.default_rng(0)
    size = np.array([WIDTH, HEIGHT])
    return torch.tensor(rng.uniform(margin, size - margin, (count, 2)))


def ramps() -> torch.Tensor:
    """Two linear images, at the pixels' centers."""
    v, u = torch.tensor(np.mgrid[:HEIGHT, :WIDTH] + 0.5)
    return torch.stack([3 * u - v + 7, 0.5 * v + u])


@given(SEEDS)
def test_projection_is_that_of_the_cameras(seed):
    rng = np.random.default_rng(seed)
    c2w, points = random_pose(rng), rng.uniform(-5, 5, (20, 3))
    uv, depth = project(*map(torch.tensor, (points, K, c2w)))
    expected_uv, expected_depth = cameras.project(points, K, c2w)
    # The same sums in another order: lengths of 10 are rounded by 1e-15, and 600 px of focal
    # length magnify that.  Times depth, for near depth 0 a coordinate is as large as you like.
    np.testing.assert_allclose(depth, expected_depth, rtol=0, atol=1e-13)
    actual = uv * depth[:, None]
    np.testing.assert_allclose(actual, expected_uv * expected_depth[:, None], rtol=0, atol=1e-10)


@given(SEEDS)
def test_the_camera_frame_undoes_camera_to_world(seed):
    rng = np.random.default_rng(seed)
    c2w, camera = torch.tensor(random_pose(rng)), torch.tensor(rng.uniform(-5, 5, (20, 3)))
    world = camera @ c2w[:3, :3].T + c2w[:3, 3]
    torch.testing.assert_close(world_to_camera(world, c2w), camera, rtol=0, atol=1e-13)


def test_in_view_is_inside_the_image_and_in_front():
    uv = torch.tensor([[0.0, 0], [23.9, 15.9], [24, 8], [8, 16], [-0.1, 8], [8, -0.1], [8, 8]])
    depth = torch.tensor([1.0, 1, 1, 1, 1, 1, -1])
    assert is_in_view(uv, depth, WIDTH, HEIGHT).tolist() == [True, True] + [False] * 5


def test_the_cameras_own_center_is_in_no_view_and_has_finite_features():
    uv, depth = project(torch.zeros(20, 3), torch.tensor(K).float(), torch.eye(4))
    assert not is_in_view(uv, depth, 640, 480).any()
    assert sample_features(torch.rand(2, 8, 8), uv, 640, 480).isfinite().all()


@pytest.mark.parametrize("coarser", [1, 2, 4])
def test_a_linear_image_is_sampled_exactly(coarser):
    """So is its average over squares, which is linear through the squares' centers."""
    uv = uv_within(100, coarser / 2)  # within the outermost centers
    actual = sample_features(avg_pool2d(ramps(), coarser), uv, WIDTH, HEIGHT)
    u, v = uv.T
    expected = torch.stack([3 * u - v + 7, 0.5 * v + u], dim=1)
    torch.testing.assert_close(actual, expected, rtol=0, atol=1e-12)


def test_beyond_the_outermost_centers_the_border_goes_on():
    uv = torch.tensor([[0.0, 8], [-1e9, 8], [24, 8], [8, 0], [8, 1e9]], dtype=torch.float64)
    nearest = torch.tensor([[0.5, 8], [0.5, 8], [23.5, 8], [8, 0.5], [8, 15.5]]).double()
    torch.testing.assert_close(
        sample_features(ramps(), uv, WIDTH, HEIGHT),
        sample_features(ramps(), nearest, WIDTH, HEIGHT),
    )


def test_gradients_are_right():
    c2w = torch.tensor(random_pose(np.random.default_rng(3)))
    points = c2w[:3, 3] + (torch.tensor([[0.1, 0.2, 2], [-0.3, 0, 1.5]]).double() @ c2w[:3, :3].T)
    k = torch.tensor(K)
    # joined, for gradcheck passes over an output that has no gradient at all
    assert torch.autograd.gradcheck(
        lambda p: torch.column_stack(project(p, k, c2w)), points.requires_grad_()
    )
    features = ramps()[:, ::4, ::4].clone().requires_grad_()
    uv = torch.tensor([[7.3, 6.1], [13.9, 9.2]], dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(
        lambda f, uv: sample_features(f, uv, WIDTH, HEIGHT), (features, uv)
    )
