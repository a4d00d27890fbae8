"""Where the cameras stand: on a sphere around the part, all looking at its centre."""

import numpy as np
from jaxtyping import Bool, Float

from industnerf.errors import BadParams
from industnerf.geometry.cameras import Cameras, look_at, pinhole
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.schema import ViewsParams

ROUNDING = 1e-9  # by which a ball that just fits may seem too large
TURNS = 360  # candidates for the turn between held-out and training cameras


def bounding_ball(vertices: Float[np.ndarray, "n 3"]) -> tuple[Float[np.ndarray, "3"], float]:
    """Centre of the bounding box, and the distance (mm) of the vertex farthest from it."""
    centre = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    return centre, float(np.linalg.norm(vertices - centre, axis=1).max())


def cameras_around(
    centre: Float[np.ndarray, "3"], radius_mm: float, settings: ViewsParams
) -> tuple[Cameras, Bool[np.ndarray, "n"]]:
    """Training cameras, then held-out ones, that frame the ball; and which are held out.

    Raises BadParams if the ball is larger than the field of view.
    """
    require_in_frame(settings.radius, settings.fov_deg)
    train = fibonacci_sphere(settings.count)
    held_out = fibonacci_sphere(settings.held_out, best_turn(train, settings.held_out))
    eyes = centre + settings.radius * radius_mm * np.concatenate([train, held_out])
    K = np.tile(pinhole(settings.fov_deg, settings.resolution), (len(eyes), 1, 1))
    cameras = Cameras(K, look_at(eyes, centre), settings.resolution, settings.resolution)
    return cameras, np.arange(len(eyes)) >= settings.count


def require_in_frame(radius: float, fov_deg: float) -> None:
    """Raise BadParams unless a ball is in frame from `radius` times its own radius."""
    half = np.radians(fov_deg) / 2
    if radius * np.sin(half) >= 1 - ROUNDING:
        return
    spans = np.degrees(2 * np.arcsin(min(1 / radius, 1))) if radius > 0 else 180.0
    raise BadParams(
        f"params.yaml: the cameras do not frame the part. From views.radius = {radius:g} its "
        f"bounding ball spans {spans:.2f} degrees, {spans - fov_deg:.2f} more than views.fov_deg "
        f"= {fov_deg:g}. Raise views.radius to {round_up(1 / np.sin(half), 3):g} or views.fov_deg "
        f"to {round_up(spans, 2):g}."
    )


def round_up(value: float, digits: int) -> float:
    """`value` with so many decimals, never less than it is."""
    return float(np.ceil(value * 10**digits - ROUNDING) / 10**digits)


def best_turn(train: Float[np.ndarray, "n 3"], held_out: int) -> float:
    """The turn (radians) of `held_out` cameras that keeps them farthest from `train`."""
    if not held_out:
        return 0.0
    turns = np.arange(TURNS) * (2 * np.pi / TURNS)
    nearest = [(fibonacci_sphere(held_out, turn) @ train.T).max() for turn in turns]
    return float(turns[np.argmin(nearest)])
