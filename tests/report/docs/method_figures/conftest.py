"""A ball that is photographed by arithmetic, and what the method makes of it in a few steps."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from industnerf.config import load_params
from industnerf.geometry.cameras import (
    Cameras,
    common_view_ball,
    look_at,
    pixel_centers,
    ray_directions,
)
from industnerf.methods.industnerf.scene import PosedImages
from industnerf.report.docs.method_figures.pipeline_trace import PipelineTrace, trace_pipeline
from industnerf.schema.industnerf import LevelSettings
from industnerf.torch_kernels import use_reproducible_kernels

SIZE, VIEWS = 32, 6
CENTER, RADIUS = np.array([40.0, -20.0, 7.0]), 10.0  # mm

use_reproducible_kernels()


def ball_images() -> PosedImages:
    """The ball before white; its color is its normal's, so that all sides differ."""
    azimuths = np.linspace(0, 2 * np.pi, VIEWS, endpoint=False)
    directions = np.stack([np.cos(azimuths), np.sin(azimuths), np.sin(2 * azimuths)], axis=1)
    c2w = look_at(
        CENTER + 50 * directions / np.linalg.norm(directions, axis=1, keepdims=True), CENTER
    )
    K = np.array([[60.0, 0, SIZE / 2], [0, 60.0, SIZE / 2], [0, 0, 1]])
    cameras = Cameras(np.tile(K, (VIEWS, 1, 1)), c2w, SIZE, SIZE)
    rgb = np.stack([render_ball(K, pose) for pose in c2w])
    return PosedImages(rgb, cameras, None, *common_view_ball(cameras))


def render_ball(K: np.ndarray, c2w: np.ndarray) -> np.ndarray:
    """Rays that meet the ball, |o + t d|^2 = RADIUS^2, take the color of its normal."""
    rays, camera_center = ray_directions(pixel_centers(SIZE, SIZE), K, c2w), c2w[:3, 3] - CENTER
    half_b = rays @ camera_center
    root = half_b**2 - camera_center @ camera_center + RADIUS**2
    normal = (camera_center + (-half_b - np.sqrt(np.maximum(root, 0)))[:, None] * rays) / RADIUS
    pixels = np.where((root > 0)[:, None], 0.5 + 0.4 * normal, 1.0)
    return (255 * pixels).round().astype(np.uint8).reshape(SIZE, SIZE, 3)


@pytest.fixture(scope="session")
def trace() -> PipelineTrace:
    """The settings of params.yaml, but few and small steps."""
    settings = load_params(Path(__file__).parents[4] / "params.yaml").method.industnerf
    levels = [LevelSettings(20, SIZE, 2000), LevelSettings(10, SIZE, 3000)]
    small = replace(settings, grid_res=16, levels=levels, rays_per_step=256, min_confidence=0.01)
    return trace_pipeline("ball", ball_images(), small, 0)
