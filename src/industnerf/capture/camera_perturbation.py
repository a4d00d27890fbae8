"""Cameras off their nominal poses: jittered, or recorded by a faulty calibration.

`views.jitter` moves the cameras themselves; its draws are uniform within plus and minus their
spread, so that no camera strays further.  `views.calibration` leaves the photographs as they are
and falsifies the recorded cameras; it states root mean squares over many views of the angle between
true and recorded axes, the distance of true and recorded centers, and the focal length's error.
"""

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial.transform import Rotation

from industnerf.capture.rigs import min_camera_distance
from industnerf.capture.rng import RandomStreams
from industnerf.geometry.cameras import Cameras, look_at
from industnerf.schema import CalibrationParams, JitterParams, ViewsParams


def jitter_cameras(
    cameras: Cameras,
    center: Float[np.ndarray, "3"],
    radius_mm: float,
    settings: ViewsParams,
    view_streams: list[RandomStreams],
) -> Cameras:
    """`cameras` moved by `views.jitter`; the ball stays in every frame.

    No camera comes nearer than its frame needs (`min_camera_distance`): there the distance is cut.
    """
    if not any(vars(settings.jitter).values()):
        return cameras
    K, c2w = cameras.K.copy(), cameras.c2w.copy()
    for i, streams in enumerate(view_streams):
        rng = streams.generator("jitter")
        distance_draw, focal_draw, roll_draw = rng.uniform(-1, 1, 3)
        K[i, [0, 1], [0, 1]] *= 1 + settings.jitter.focal * focal_draw
        half_fov = np.arctan(cameras.width / 2 / K[i, 0, 0])
        distance_radii = settings.radius * (1 + settings.jitter.distance * distance_draw)
        distance_radii = max(distance_radii, min_camera_distance(half_fov, settings.jitter.look_at))
        target = _sample_disc(rng, settings, radius_mm)
        moved = _aim_off_center(c2w[i], center, distance_radii * radius_mm, target)
        c2w[i] = moved @ _roll_matrix(np.radians(settings.jitter.roll_deg) * roll_draw)
    return Cameras(K, c2w, cameras.width, cameras.height)


def max_camera_distance(settings: ViewsParams) -> float:
    """A bound on the distance of any camera from the part's center, in radii."""
    jitter: JitterParams = settings.jitter
    if not any(vars(jitter).values()):
        return settings.radius
    min_half_fov = np.arctan(np.tan(np.radians(settings.fov_deg) / 2) / (1 + jitter.focal))
    return max(
        settings.radius * (1 + jitter.distance), min_camera_distance(min_half_fov, jitter.look_at)
    )


def _sample_disc(
    rng: np.random.Generator, settings: ViewsParams, radius_mm: float
) -> Float[np.ndarray, "2"]:
    """A point (mm) of the disc of radius `views.jitter.look_at`, uniform in area."""
    share, angle = rng.uniform(0, 1), rng.uniform(0, 2 * np.pi)
    disc_radius = settings.jitter.look_at * radius_mm * np.sqrt(share)
    return disc_radius * np.array([np.cos(angle), np.sin(angle)])


def _aim_off_center(
    c2w: Float[np.ndarray, "4 4"],
    center: Float[np.ndarray, "3"],
    distance_mm: float,
    aim_offset_mm: Float[np.ndarray, "2"],
) -> Float[np.ndarray, "4 4"]:
    """A camera `distance_mm` from the center in the same direction, that looks past the center.

    The point looked at is shifted across the line of sight: along it a shift changes nothing.
    """
    camera_center = center - distance_mm * c2w[:3, 2]
    return look_at(camera_center[None], center + c2w[:3, :2] @ aim_offset_mm)[0]


def _roll_matrix(angle: float) -> Float[np.ndarray, "4 4"]:
    """A turn about the optical axis."""
    matrix = np.eye(4)
    matrix[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    return matrix


def is_exact(calibration: CalibrationParams) -> bool:
    """Whether the recorded cameras are the true ones."""
    return not any(vars(calibration).values())


def perturbed_cameras(
    cameras: Cameras,
    held_out: Bool[np.ndarray, "n"],
    center: Float[np.ndarray, "3"],
    calibration: CalibrationParams,
    view_streams: list[RandomStreams],
) -> Cameras:
    """The recorded cameras of the true `cameras`: training cameras off, held-out ones exact.

    Held-out views evaluate; were their cameras wrong, they would evaluate the calibration too.
    """
    if is_exact(calibration):
        return cameras
    K, c2w = cameras.K.copy(), cameras.c2w.copy()
    for i in np.flatnonzero(~held_out):
        rng = view_streams[i].generator("calibration")
        axis, step = rng.standard_normal((2, 3))
        angle, stretch = rng.standard_normal(2)
        angle *= np.radians(calibration.rotation_deg)
        rotation = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis)).as_matrix()
        c2w[i, :3, :3] = rotation @ c2w[i, :3, :3]
        distance = np.linalg.norm(cameras.centers[i] - center)
        c2w[i, :3, 3] += calibration.position * distance * step / np.sqrt(3)  # three coordinates
        # never negative, and a share of the focal length to first order
        K[i, [0, 1], [0, 1]] *= np.exp(calibration.focal * stretch)
    return Cameras(K, c2w, cameras.width, cameras.height)
