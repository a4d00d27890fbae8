"""Textured solids, photographs of them by an analytic ray caster, and small settings.

Everything is about `CENTER`, in mm, and `REACH` is the radius of the ball that cameras frame.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch

from industnerf.config import load_params
from industnerf.geometry.cameras import Cameras, ray_directions
from industnerf.methods.industnerf.scene import NerfScene, PosedImages, make_scene
from industnerf.methods.industnerf_plus.silhouette_carving import Silhouettes
from industnerf.schema import IndustnerfSettings
from tests.methods.solids import cameras_around

CPU = torch.device("cpu")
CENTER = np.array([300.0, -150.0, 90.0])
SCENE_RADIUS = 30.0
WHITE = 1.0
TOLERANCE = 0.02  # further from the background's color than this is not background
SUPERSAMPLING = 4  # rays of a pixel, along each side


@dataclass(frozen=True)
class Solid:
    """A solid about the origin."""

    hit_distance: Callable[[np.ndarray, np.ndarray], np.ndarray]  # distance along rays; inf: missed
    signed_distance: Callable[
        [np.ndarray], np.ndarray
    ]  # signed distance of points to the surface, mm


def ball(radius: float) -> Solid:
    def hit_distance(origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
        half = -(origins * directions).sum(axis=1)
        discriminant = half**2 - (origins**2).sum(axis=1) + radius**2
        return np.where(discriminant > 0, half - np.sqrt(np.maximum(discriminant, 0)), np.inf)

    return Solid(hit_distance, lambda points: np.linalg.norm(points, axis=1) - radius)


def box(half: tuple[float, float, float]) -> Solid:
    def hit_distance(origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
        faces = np.stack([(side * np.array(half) - origins) / directions for side in (-1, 1)])
        enter, leave = faces.min(axis=0).max(axis=1), faces.max(axis=0).min(axis=1)
        return np.where(enter < leave, enter, np.inf)

    def signed_distance(points: np.ndarray) -> np.ndarray:
        offset = np.abs(points) - half
        outside = np.linalg.norm(np.maximum(offset, 0), axis=1)
        return outside + np.minimum(offset.max(axis=1), 0)

    return Solid(hit_distance, signed_distance)


def translate(solid: Solid, offset: tuple[float, float, float]) -> Solid:
    return Solid(
        lambda origins, directions: solid.hit_distance(origins - offset, directions),
        lambda points: solid.signed_distance(points - offset),
    )


def union(*solids: Solid) -> Solid:
    """All of them; `away` is right outside of all, and near the surface of one alone."""
    return Solid(
        lambda origins, directions: np.min(
            [s.hit_distance(origins, directions) for s in solids], axis=0
        ),
        lambda points: np.min([s.signed_distance(points) for s in solids], axis=0),
    )


def cup() -> Solid:
    """A box of 32 x 32 x 20 mm with a pocket of 24 x 24 x 16 mm, open upwards."""
    floor = translate(box((16.0, 16.0, 2.0)), (0.0, 0.0, -8.0))
    along = [translate(box((16.0, 2.0, 10.0)), (0.0, side, 0.0)) for side in (-14.0, 14.0)]
    across = [translate(box((2.0, 16.0, 10.0)), (side, 0.0, 0.0)) for side in (-14.0, 14.0)]
    return union(floor, *along, *across)


def texture(points: np.ndarray) -> np.ndarray:
    """Colors in [0.1, 0.8] that wave across the solid, an axis a channel."""
    return 0.45 + 0.35 * np.sin(points / 5)


def orbit_cameras(count: int, resolution: int) -> Cameras:
    return cameras_around(count, resolution, SCENE_RADIUS, tuple(CENTER))


def render_images(solid: Solid, cameras: Cameras, background: float = WHITE) -> np.ndarray:
    """Each pixel the mean of `SIDE` x `SIDE` rays, before a background."""
    subpixel = (np.arange(SUPERSAMPLING) + 0.5) / SUPERSAMPLING
    u, v = (np.arange(size)[:, None] + subpixel for size in (cameras.width, cameras.height))
    uv = np.stack(np.meshgrid(u.ravel(), v.ravel()), axis=-1).reshape(-1, 2)
    images = []
    for K, c2w in zip(cameras.K, cameras.c2w, strict=True):
        directions = ray_directions(uv, K, c2w)
        origins = np.broadcast_to(c2w[:3, 3] - CENTER, directions.shape)
        t = solid.hit_distance(origins, directions)
        hit = np.isfinite(t)
        colors = np.full(directions.shape, background)
        colors[hit] = texture(origins[hit] + t[hit, None] * directions[hit])
        image = colors.reshape(cameras.height, SUPERSAMPLING, cameras.width, SUPERSAMPLING, 3).mean(
            axis=(1, 3)
        )
        images.append((image * 255).round().astype(np.uint8))
    return np.stack(images)


def make_posed_images(
    solid: Solid, count: int = 12, resolution: int = 48, background: float | None = WHITE
) -> PosedImages:
    cameras = orbit_cameras(count, resolution)
    backgrounds = None if background is None else np.full((count, 3), background)
    return PosedImages(render_images(solid, cameras), cameras, backgrounds, CENTER, SCENE_RADIUS)


def make_test_scene(solid: Solid, count: int = 12, resolution: int = 48) -> NerfScene:
    return make_scene(make_posed_images(solid, count, resolution), CPU)


def make_silhouettes(views: NerfScene) -> Silhouettes:
    """A pixel is background if no channel is further than 0.02 from it."""
    return Silhouettes(views, TOLERANCE)


def default_settings(name: str) -> IndustnerfSettings:
    """Those of params.yaml."""
    return getattr(load_params(Path(__file__).parents[3] / "params.yaml").method, name)


def settings(
    name: str = "industnerf",
    *,
    readings: dict[str, Any] | None = None,
    network: dict[str, Any] | None = None,
    residual: dict[str, Any] | None = None,
    levels: list[dict[str, int]] | None = None,
    warm_up: dict[str, int] | None = None,
    **others: Any,
) -> IndustnerfSettings:
    """Those of params.yaml, with so few points, steps and rays that tests are quick.

    The paper's method has densities, whose closed forms are known, unless distances are asked for.
    """
    defaults = default_settings(name)
    if name == "industnerf_plus":
        polish = {"enabled": False} | others.pop("polish", {})
        others |= {"polish": replace(defaults.polish, **polish)}
    if name.startswith("industnerf") and name != "industnerf_plus":
        readings = {"density_activation": "truncated_exp"} | (readings or {})
        has_raw_density = readings["density_activation"] != "sdf"
        others = ({"density_bias": -4.0} if has_raw_density else {}) | others
    level = {"steps": 10, "image_px": 32, "points": 2000}
    return replace(
        defaults,
        readings=replace(defaults.readings, **(readings or {})),
        network=replace(
            defaults.network, **{"encoding_channels": 24, "hidden_dim": 32} | (network or {})
        ),
        residual=replace(defaults.residual, **(residual or {})),
        levels=[replace(defaults.levels[0], **level | extra) for extra in levels or [{}]],
        warm_up=replace(defaults.warm_up, **{"steps": 0} | (warm_up or {})),
        **{"grid_res": 12, "rays_per_step": 256} | others,
    )


FREE_POINTS = {
    "network": {"enabled": False},
    "residual": {"enabled": True},
}  # every point by itself
WITH_RESIDUAL = {"residual": {"enabled": True}}
