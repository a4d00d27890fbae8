"""Textured solids, photographs of them by an analytic ray caster, and small settings.

Everything is about `CENTRE`, in mm, and `REACH` is the radius of the ball that cameras frame.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch

from industnerf.config import load_params
from industnerf.geometry.cameras import Cameras, ray_directions
from industnerf.methods.industnerf.carving import Silhouettes
from industnerf.methods.industnerf.scene import Posed, Scene, scene_of
from industnerf.schema import IndustnerfSettings
from tests.methods.solids import cameras_around

CPU = torch.device("cpu")
CENTRE = np.array([300.0, -150.0, 90.0])
REACH = 30.0
WHITE = 1.0
TOLERANCE = 0.02  # further from the background's colour than this is not background
SIDE = 4  # rays of a pixel, along each side


@dataclass(frozen=True)
class Solid:
    """A solid about the origin."""

    meets: Callable[[np.ndarray, np.ndarray], np.ndarray]  # distance along rays; inf: missed
    away: Callable[[np.ndarray], np.ndarray]  # signed distance of points to the surface, mm


def ball(radius: float) -> Solid:
    def meets(origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
        half = -(origins * directions).sum(axis=1)
        room = half**2 - (origins**2).sum(axis=1) + radius**2
        return np.where(room > 0, half - np.sqrt(np.maximum(room, 0)), np.inf)

    return Solid(meets, lambda points: np.linalg.norm(points, axis=1) - radius)


def box(half: tuple[float, float, float]) -> Solid:
    def meets(origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
        faces = np.stack([(side * np.array(half) - origins) / directions for side in (-1, 1)])
        enter, leave = faces.min(axis=0).max(axis=1), faces.max(axis=0).min(axis=1)
        return np.where(enter < leave, enter, np.inf)

    def away(points: np.ndarray) -> np.ndarray:
        beyond = np.abs(points) - half
        outside = np.linalg.norm(np.maximum(beyond, 0), axis=1)
        return outside + np.minimum(beyond.max(axis=1), 0)

    return Solid(meets, away)


def moved(solid: Solid, by: tuple[float, float, float]) -> Solid:
    return Solid(
        lambda origins, directions: solid.meets(origins - by, directions),
        lambda points: solid.away(points - by),
    )


def united(*solids: Solid) -> Solid:
    """All of them; `away` is right outside of all, and near the surface of one alone."""
    return Solid(
        lambda origins, directions: np.min([s.meets(origins, directions) for s in solids], axis=0),
        lambda points: np.min([s.away(points) for s in solids], axis=0),
    )


def cup() -> Solid:
    """A box of 32 x 32 x 20 mm with a pocket of 24 x 24 x 16 mm, open upwards."""
    floor = moved(box((16.0, 16.0, 2.0)), (0.0, 0.0, -8.0))
    along = [moved(box((16.0, 2.0, 10.0)), (0.0, side, 0.0)) for side in (-14.0, 14.0)]
    across = [moved(box((2.0, 16.0, 10.0)), (side, 0.0, 0.0)) for side in (-14.0, 14.0)]
    return united(floor, *along, *across)


def texture(points: np.ndarray) -> np.ndarray:
    """Colours in [0.1, 0.8] that wave across the solid, an axis a channel."""
    return 0.45 + 0.35 * np.sin(points / 5)


def around(count: int, resolution: int) -> Cameras:
    return cameras_around(count, resolution, REACH, tuple(CENTRE))


def photographs(solid: Solid, cameras: Cameras, behind: float = WHITE) -> np.ndarray:
    """Each pixel the mean of `SIDE` x `SIDE` rays, before a background."""
    sub = (np.arange(SIDE) + 0.5) / SIDE
    u, v = (np.arange(size)[:, None] + sub for size in (cameras.width, cameras.height))
    uv = np.stack(np.meshgrid(u.ravel(), v.ravel()), axis=-1).reshape(-1, 2)
    seen = []
    for K, c2w in zip(cameras.K, cameras.c2w, strict=True):
        directions = ray_directions(uv, K, c2w)
        origins = np.broadcast_to(c2w[:3, 3] - CENTRE, directions.shape)
        t = solid.meets(origins, directions)
        hit = np.isfinite(t)
        colours = np.full(directions.shape, behind)
        colours[hit] = texture(origins[hit] + t[hit, None] * directions[hit])
        whole = colours.reshape(cameras.height, SIDE, cameras.width, SIDE, 3).mean(axis=(1, 3))
        seen.append((whole * 255).round().astype(np.uint8))
    return np.stack(seen)


def posed(
    solid: Solid, count: int = 12, resolution: int = 48, background: float | None = WHITE
) -> Posed:
    cameras = around(count, resolution)
    known = None if background is None else np.full((count, 3), background)
    return Posed(photographs(solid, cameras), cameras, known, CENTRE, REACH)


def scene(solid: Solid, count: int = 12, resolution: int = 48) -> Scene:
    return scene_of(posed(solid, count, resolution), CPU)


def silhouettes_of(seen: Scene) -> Silhouettes:
    """A pixel is background if no channel is further than 0.02 from it."""
    return Silhouettes(seen, TOLERANCE)


def shipped(name: str) -> IndustnerfSettings:
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
    recolour: dict[str, float] | None = None,
    **others: Any,
) -> IndustnerfSettings:
    """Those of params.yaml, with so few points, steps and rays that tests are quick.

    The paper's method has densities, whose closed forms are known, unless distances are asked for.
    """
    whole = shipped(name)
    if name.startswith("industnerf") and name != "industnerf_plus":
        readings = {"activation": "cut_exp"} | (readings or {})
        dense = readings["activation"] != "distance"
        others = ({"initial": -4.0} if dense else {}) | others
    level = {"steps": 10, "image_px": 32, "points": 2000}
    return replace(
        whole,
        readings=replace(whole.readings, **(readings or {})),
        network=replace(whole.network, **{"channels": 24, "hidden": 32} | (network or {})),
        residual=replace(whole.residual, **(residual or {})),
        levels=[replace(whole.levels[0], **level | extra) for extra in levels or [{}]],
        warm_up=replace(whole.warm_up, **{"steps": 0} | (warm_up or {})),
        recolour=replace(whole.recolour, **{"steps": 0} | (recolour or {})),
        **{"grid_res": 12, "rays": 256} | others,
    )


FREE = {"network": {"use": False}, "residual": {"use": True}}  # every point by itself
BOTH = {"residual": {"use": True}}
