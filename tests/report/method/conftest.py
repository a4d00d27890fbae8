"""A ball that is photographed by arithmetic, and what the method makes of it in a few steps."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from industnerf.config import load_params
from industnerf.geometry.cameras import Cameras, framed_ball, look_at, pixel_centres, ray_directions
from industnerf.methods.industnerf.scene import Posed
from industnerf.report.method.making import Making, make
from industnerf.schema.industnerf import LevelSettings

SIZE, VIEWS = 32, 6
CENTRE, RADIUS = np.array([40.0, -20.0, 7.0]), 10.0  # mm

torch.set_num_threads(1)


def photographs() -> Posed:
    """The ball before white; its colour is its normal's, so that all sides differ."""
    turns = np.linspace(0, 2 * np.pi, VIEWS, endpoint=False)
    away = np.stack([np.cos(turns), np.sin(turns), np.sin(2 * turns)], axis=1)
    c2w = look_at(CENTRE + 50 * away / np.linalg.norm(away, axis=1, keepdims=True), CENTRE)
    K = np.array([[60.0, 0, SIZE / 2], [0, 60.0, SIZE / 2], [0, 0, 1]])
    cameras = Cameras(np.tile(K, (VIEWS, 1, 1)), c2w, SIZE, SIZE)
    rgb = np.stack([one_photograph(K, pose) for pose in c2w])
    return Posed(rgb, cameras, None, *framed_ball(cameras))


def one_photograph(K: np.ndarray, c2w: np.ndarray) -> np.ndarray:
    """Rays that meet the ball, |o + t d|^2 = RADIUS^2, take the colour of its normal."""
    rays, eye = ray_directions(pixel_centres(SIZE, SIZE), K, c2w), c2w[:3, 3] - CENTRE
    half = rays @ eye
    root = half**2 - eye @ eye + RADIUS**2
    normal = (eye + (-half - np.sqrt(np.maximum(root, 0)))[:, None] * rays) / RADIUS
    pixels = np.where((root > 0)[:, None], 0.5 + 0.4 * normal, 1.0)
    return (255 * pixels).round().astype(np.uint8).reshape(SIZE, SIZE, 3)


@pytest.fixture(scope="session")
def making() -> Making:
    """The settings of params.yaml, but few and small steps."""
    settings = load_params(Path(__file__).parents[3] / "params.yaml").method.industnerf
    levels = [LevelSettings(20, SIZE, 2000), LevelSettings(10, SIZE, 3000)]
    small = replace(settings, grid_res=16, levels=levels, rays=256, least_confidence=0.01)
    return make("ball", photographs(), small, 0)
