"""Pinhole cameras: projection, back-projection, rays, and subsets of views."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float32, Int64

TIE_TOLERANCE = 1e-9  # distances that differ by less than this share of them are equal


@dataclass(frozen=True)
class Cameras:
    """`n` pinhole cameras of one image size."""

    K: Float[np.ndarray, "n 3 3"]  # intrinsics, px
    c2w: Float[np.ndarray, "n 4 4"]  # camera to world, mm
    width: int
    height: int

    def __len__(self) -> int:
        return len(self.K)

    def __getitem__(self, index: slice | np.ndarray) -> "Cameras":
        return Cameras(self.K[index], self.c2w[index], self.width, self.height)

    @property
    def centers(self) -> Float[np.ndarray, "n 3"]:
        """Centers of projection, mm."""
        return self.c2w[:, :3, 3]


def reduced_size(width: int, height: int, longest: int) -> tuple[int, int]:
    """(width, height) with a long side of at most `longest` px, the shape kept to half a pixel."""
    factor = min(1.0, longest / max(width, height))
    return max(1, round(width * factor)), max(1, round(height * factor))


def pixel_centers(width: int, height: int) -> Float[np.ndarray, "pixels 2"]:
    """(u, v) of every pixel's center in px, row by row."""
    v, u = np.mgrid[:height, :width] + 0.5
    return np.stack([u.ravel(), v.ravel()], axis=-1)


def back_projection(
    K: Float[np.ndarray, "3 3"], c2w: Float[np.ndarray, "4 4"]
) -> Float[np.ndarray, "3 3"]:
    """The matrix that takes (u, v, 1) to a ray direction in the world with z = 1 in the camera.

    Along such a direction, the length of the ray counted in directions is the depth in mm.
    """
    return c2w[:3, :3] @ np.linalg.inv(K)


def ray_directions(
    uv: Float[np.ndarray, "pixels 2"],
    K: Float[np.ndarray, "3 3"],
    c2w: Float[np.ndarray, "4 4"],
) -> Float[np.ndarray, "pixels 3"]:
    """Unit directions, in the world, of the rays from the camera center through the pixels `uv`."""
    pixel_to_ray = back_projection(K, c2w)
    directions = uv @ pixel_to_ray[:, :2].T + pixel_to_ray[:, 2]
    # vector norm by einsum: several times faster than linalg.norm on three columns
    length = np.sqrt(np.einsum("ij,ij->i", directions, directions))
    return directions / length[:, None]


def unproject(
    uv: Float[np.ndarray, "n 2"],
    depth_mm: Float[np.ndarray, "n"],
    K: Float[np.ndarray, "3 3"],
    c2w: Float[np.ndarray, "4 4"],
) -> Float[np.ndarray, "n 3"]:
    """World points (mm) that the pixels `uv` show at `depth_mm`: the inverse of `project`."""
    pixel_to_ray = back_projection(K, c2w)
    return c2w[:3, 3] + depth_mm[:, None] * (uv @ pixel_to_ray[:, :2].T + pixel_to_ray[:, 2])


def project(
    points: Float[np.ndarray, "n 3"],
    K: Float[np.ndarray, "3 3"],
    c2w: Float[np.ndarray, "4 4"],
) -> tuple[Float[np.ndarray, "n 2"], Float[np.ndarray, "n"]]:
    """Pixel coordinates (px) and depth (z in the camera frame, mm) of world points."""
    camera_points = (points - c2w[:3, 3]) @ c2w[:3, :3]
    homogeneous = camera_points @ K.T
    return homogeneous[:, :2] / homogeneous[:, 2:], camera_points[:, 2]


def look_at(
    camera_centers: Float[np.ndarray, "n 3"], target: Float[np.ndarray, "3"]
) -> Float[np.ndarray, "n 4 4"]:
    """Camera-to-world transforms that look from `camera_centers` at `target`, world +z upwards.

    A camera straight above or below the target takes +y for up instead.
    """
    forward = target - camera_centers
    forward /= np.linalg.norm(forward, axis=1, keepdims=True)
    is_vertical = np.abs(forward[:, 2]) > 1 - 1e-9
    up = np.where(is_vertical[:, None], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0])
    right = np.cross(forward, up)
    right /= np.linalg.norm(right, axis=1, keepdims=True)
    c2w = np.tile(np.eye(4), (len(camera_centers), 1, 1))
    c2w[:, :3, 0], c2w[:, :3, 2], c2w[:, :3, 3] = right, forward, camera_centers
    c2w[:, :3, 1] = np.cross(forward, right)  # +y down completes the right-handed frame
    return c2w


def pinhole(fov_deg: float, resolution: int) -> Float[np.ndarray, "3 3"]:
    """Intrinsics of a square image whose side spans `fov_deg` degrees."""
    focal = resolution / 2 / np.tan(np.radians(fov_deg) / 2)
    return np.array([[focal, 0, resolution / 2], [0, focal, resolution / 2], [0, 0, 1.0]])


def common_view_ball(cameras: Cameras) -> tuple[Float[np.ndarray, "3"], float]:
    """Center and radius (mm) of the ball that every camera would have in frame if it aimed at it.

    The center is the point nearest to all optical axes in the least-squares sense, the radius
    the smallest over the cameras of (distance x sin of half the field of view), as if each looked
    straight at the center.  It is the region of interest that a method may derive from its cameras
    alone.
    """
    axes, camera_centers = cameras.c2w[:, :3, 2], cameras.centers
    axis_projections = np.eye(3) - axes[:, :, None] * axes[:, None, :]  # projections off each axis
    center = np.linalg.lstsq(
        axis_projections.sum(0),
        (axis_projections @ camera_centers[:, :, None]).sum(0)[:, 0],
        rcond=None,
    )[0]
    distance = np.linalg.norm(camera_centers - center, axis=1)
    half_width = np.minimum(
        cameras.width / 2 / cameras.K[:, 0, 0], cameras.height / 2 / cameras.K[:, 1, 1]
    )
    return center, float((distance * np.sin(np.arctan(half_width))).min())


def unit_ball_projections(
    cameras: Cameras, center: Float[np.ndarray, "3"], radius_mm: float
) -> Float32[np.ndarray, "n 3 4"]:
    """Matrices from (x, y, z, 1) to (u d, v d, d), d the depth, in units of a ball's radius.

    (x, y, z) and d are in that unit, the ball is about the origin, u and v are in px.
    """
    to_mm = np.diag([radius_mm, radius_mm, radius_mm, 1.0])
    to_mm[:3, 3] = center
    return (cameras.K @ np.linalg.inv(cameras.c2w)[:, :3] @ to_mm / radius_mm).astype(np.float32)


def nested_view_order(
    positions: Float[np.ndarray, "n 3"], count: int
) -> Int64[np.ndarray, "count"]:
    """Indices of `count` of `positions`: the first, and each next the farthest from all before.

    So the first few of them look from all round.  Of positions alike far, to rounding, the one with
    the lower index is taken: a rig has one order about any part.  `count` is at most n.
    """
    chosen = [0]
    distance = np.full(len(positions), np.inf)
    while len(chosen) < count:
        distance = np.minimum(distance, np.linalg.norm(positions - positions[chosen[-1]], axis=1))
        distance[chosen] = -1.0
        chosen.append(int((distance >= (1 - TIE_TOLERANCE) * distance.max()).argmax()))
    return np.array(chosen)


def nested_view_subset(
    positions: Float[np.ndarray, "n 3"], count: int
) -> Int64[np.ndarray, "count"]:
    """`nested_view_order`, ascending: a subset of any size contains all smaller ones."""
    return np.sort(nested_view_order(positions, count))
