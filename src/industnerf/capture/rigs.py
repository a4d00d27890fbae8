"""Where the cameras stand: around the part, all looking at its center.

A turntable has the same elevations all round, some elevations one above the other.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float

from industnerf.errors import BadParams
from industnerf.geometry.cameras import Cameras, look_at, pinhole
from industnerf.geometry.sphere import fibonacci_hemisphere, fibonacci_sphere
from industnerf.schema import ViewsParams

FIT_TOLERANCE = 1e-9  # by which a ball that just fits may seem too large
NUM_AZIMUTHS = 360  # candidates for the turn between held-out and training cameras

Directions = Float[np.ndarray, "_ 3"]
Elevations = Float[np.ndarray, "rings"]  # radians
Lattice = Callable[[int, float], Directions]


def bounding_ball(vertices: Float[np.ndarray, "n 3"]) -> tuple[Float[np.ndarray, "3"], float]:
    """Center of the bounding box, and the distance (mm) of the vertex farthest from it."""
    center = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    return center, float(np.linalg.norm(vertices - center, axis=1).max())


def cameras_around(
    center: Float[np.ndarray, "3"], radius_mm: float, settings: ViewsParams
) -> tuple[Cameras, Bool[np.ndarray, "n"]]:
    """Training cameras, then held-out ones, that frame the ball; and which are held out.

    Raises BadParams if the ball is larger than the field of view.
    """
    require_in_frame(settings)
    camera_centers = center + settings.radius * radius_mm * np.concatenate(directions(settings))
    K = np.tile(pinhole(settings.fov_deg, settings.resolution), (len(camera_centers), 1, 1))
    cameras = Cameras(K, look_at(camera_centers, center), settings.resolution, settings.resolution)
    return cameras, np.arange(len(camera_centers)) >= settings.count


def directions(settings: ViewsParams) -> tuple[Directions, Directions]:
    """Unit vectors towards the training cameras and towards the held-out ones.

    Both stand on the same kind of rig, the held-out ones as far from the others as it allows.
    """
    count, held_out = settings.count, settings.held_out
    if settings.rig == "turntable":
        elevations = np.radians(settings.elevations_deg)
        return ring_directions(count, elevations), held_out_directions(count, held_out, elevations)
    lattice = fibonacci_sphere if settings.rig == "sphere" else fibonacci_hemisphere
    train = lattice(count, 0.0)
    return train, lattice(held_out, best_azimuth_offset(train, held_out, lattice))


def best_azimuth_offset(train: Directions, held_out: int, lattice: Lattice) -> float:
    """The turn (radians) of `held_out` cameras that keeps them farthest from `train`."""
    if not held_out:
        return 0.0
    azimuths = np.arange(NUM_AZIMUTHS) * (2 * np.pi / NUM_AZIMUTHS)
    nearest = [(lattice(held_out, azimuth) @ train.T).max() for azimuth in azimuths]
    return float(azimuths[np.argmin(nearest)])


def min_camera_distance(half_fov: float, aim_offset: float) -> float:
    """The distance, in radii, from which a ball fits half a field of view of `half_fov` radians.

    It does so wherever within `aim_offset` radii of its center the camera aims: from the distance d
    the center is at most atan(aim_offset / d) off the axis, and asin(1 / d) wide; together they are
    less than asin((1 + aim_offset) / d), for asin is convex.
    """
    return (1 + aim_offset) / np.sin(half_fov)


def require_in_frame(settings: ViewsParams) -> None:
    """Raise BadParams unless the ball is in frame from where the rig has its cameras."""
    radius, fov_deg, aim_offset = settings.radius, settings.fov_deg, settings.jitter.look_at
    needed = min_camera_distance(np.radians(fov_deg) / 2, aim_offset)
    if radius >= needed * (1 - FIT_TOLERANCE):
        return
    radius_with_aim = 1 + aim_offset
    spans = np.degrees(2 * np.arcsin(min(radius_with_aim / radius, 1))) if radius > 0 else 180.0
    aiming = (
        f", with {aim_offset:g} radii around it for views.jitter.look_at," if aim_offset else ""
    )
    raise BadParams(
        f"params.yaml: the cameras do not frame the part. From views.radius = {radius:g} its "
        f"bounding ball{aiming} spans {spans:.2f} degrees, {spans - fov_deg:.2f} more than "
        f"views.fov_deg = {fov_deg:g}. Raise views.radius to {round_up(needed, 3):g} or "
        f"views.fov_deg to {round_up(spans, 2):g}."
    )


def round_up(value: float, digits: int) -> float:
    """`value` with so many decimals, never less than it is."""
    return float(np.ceil(value * 10**digits - FIT_TOLERANCE) / 10**digits)


def ring_directions(count: int, elevations: Elevations) -> Float[np.ndarray, "{count} 3"]:
    """`count` unit vectors, ring by ring.

    The rings share them as evenly as possible, the first having one more; each ring is evenly
    spaced, and turned by its part of a step, so that no two rings of equally many cameras have
    any at one azimuth.
    """
    azimuths = [
        (np.arange(n) + ring / len(elevations)) / max(n, 1)
        for ring, n in enumerate(split_evenly(count, len(elevations)))
    ]
    return _unit_vectors(elevations, azimuths)


def held_out_directions(
    count: int, held_out: int, elevations: Elevations
) -> Float[np.ndarray, "{held_out} 3"]:
    """`held_out` unit vectors on the rings of `count` others, in the middles of their gaps.

    Where a ring has more of them than gaps, they divide its gaps evenly.
    """
    azimuths, levels = [], len(elevations)
    per_ring = zip(split_evenly(count, levels), split_evenly(held_out, levels), strict=True)
    for ring, (gaps, n) in enumerate(per_ring):
        gaps = max(gaps, 1)
        slots_per_gap = -(-n // gaps)  # in a gap
        # the rings begin at different gaps, so that they do not leave the same side out
        slot = ((np.arange(n) + ring / levels) * (gaps * slots_per_gap) / max(n, 1)).astype(int)
        gap, slot_in_gap = slot // max(slots_per_gap, 1), slot % max(slots_per_gap, 1)
        azimuths.append((gap + (slot_in_gap + 1) / (slots_per_gap + 1) + ring / levels) / gaps)
    return _unit_vectors(elevations, azimuths)


def split_evenly(count: int, levels: int) -> list[int]:
    """`count` in `levels` whole parts that differ by one at most."""
    return [count // levels + (level < count % levels) for level in range(levels)]


def _unit_vectors(
    elevations: Elevations, azimuths: list[Float[np.ndarray, "_"]]
) -> Float[np.ndarray, "_ 3"]:
    """Unit vectors of every ring's azimuths, which are in turns."""
    elevation = np.repeat(elevations, [len(ring) for ring in azimuths])
    angle = 2 * np.pi * np.concatenate(azimuths)
    return np.stack(
        [np.cos(elevation) * np.cos(angle), np.cos(elevation) * np.sin(angle), np.sin(elevation)],
        axis=1,
    )
