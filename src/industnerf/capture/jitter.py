"""Cameras as a hand or a worn turntable would place them: near the rig's places, not in them.

All draws are uniform within plus and minus their spread, so that no camera can stray further.
"""

import numpy as np
from jaxtyping import Float

from industnerf.capture.chance import Draws
from industnerf.capture.rigs import least_distance
from industnerf.geometry.cameras import Cameras, look_at
from industnerf.schema import JitterParams, ViewsParams


def jittered(
    cameras: Cameras,
    centre: Float[np.ndarray, "3"],
    radius_mm: float,
    settings: ViewsParams,
    draws: list[Draws],
) -> Cameras:
    """`cameras` off their places by `views.jitter`; the ball stays in every frame.

    No camera comes nearer than its frame needs (`least_distance`): there the distance is cut.
    """
    if not any(vars(settings.jitter).values()):
        return cameras
    K, c2w = cameras.K.copy(), cameras.c2w.copy()
    for i, each in enumerate(draws):
        rng = each.of("jitter")
        distance, focal, roll = rng.uniform(-1, 1, 3)
        K[i, [0, 1], [0, 1]] *= 1 + settings.jitter.focal * focal
        half = np.arctan(cameras.width / 2 / K[i, 0, 0])
        away = settings.radius * (1 + settings.jitter.distance * distance)
        away = max(away, least_distance(half, settings.jitter.aim))
        moved = _aimed_aside(c2w[i], centre, away * radius_mm, _in_disc(rng, settings, radius_mm))
        c2w[i] = moved @ _rolled(np.radians(settings.jitter.roll_deg) * roll)
    return Cameras(K, c2w, cameras.width, cameras.height)


def farthest(settings: ViewsParams) -> float:
    """A bound on the distance of any camera from the part's centre, in radii."""
    jitter: JitterParams = settings.jitter
    if not any(vars(jitter).values()):
        return settings.radius
    narrowest = np.arctan(np.tan(np.radians(settings.fov_deg) / 2) / (1 + jitter.focal))
    return max(settings.radius * (1 + jitter.distance), least_distance(narrowest, jitter.aim))


def _in_disc(
    rng: np.random.Generator, settings: ViewsParams, radius_mm: float
) -> Float[np.ndarray, "2"]:
    """A point (mm) of the disc of radius `aim`, uniform in area."""
    share, turn = rng.uniform(0, 1), rng.uniform(0, 2 * np.pi)
    reach = settings.jitter.aim * radius_mm * np.sqrt(share)
    return reach * np.array([np.cos(turn), np.sin(turn)])


def _aimed_aside(
    c2w: Float[np.ndarray, "4 4"],
    centre: Float[np.ndarray, "3"],
    away_mm: float,
    aside_mm: Float[np.ndarray, "2"],
) -> Float[np.ndarray, "4 4"]:
    """A camera `away_mm` from the centre in the same direction, that looks past the centre.

    The point looked at is shifted across the line of sight: along it a shift changes nothing.
    """
    eye = centre - away_mm * c2w[:3, 2]
    return look_at(eye[None], centre + c2w[:3, :2] @ aside_mm)[0]


def _rolled(angle: float) -> Float[np.ndarray, "4 4"]:
    """A turn about the optical axis."""
    turn = np.eye(4)
    turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    return turn
