"""Solids whose hull is known, cameras around them, and the silhouettes that these see."""

from collections.abc import Callable

import numpy as np
import trimesh

from industnerf.geometry.cameras import Cameras, look_at, pinhole, pixel_centers, ray_directions
from industnerf.geometry.raycast import RaycastingScene
from industnerf.geometry.sphere import fibonacci_sphere

FOV_DEG, DISTANCE = 30.0, 4.1  # distance of the cameras, in radii of what they frame


def cameras_at(
    directions: np.ndarray, resolution: int, radius: float, center: tuple[float, ...] = (0, 0, 0)
) -> Cameras:
    """Cameras in `directions` that frame the ball of `radius` mm."""
    camera_centers = np.array(center) + DISTANCE * radius * directions
    K = np.tile(pinhole(FOV_DEG, resolution), (len(camera_centers), 1, 1))
    return Cameras(K, look_at(camera_centers, np.array(center, float)), resolution, resolution)


def cameras_around(
    count: int, resolution: int, radius: float, center: tuple[float, ...] = (0, 0, 0)
) -> Cameras:
    """`count` cameras, spread evenly."""
    return cameras_at(fibonacci_sphere(count), resolution, radius, center)


def pixel_mm(cameras: Cameras, radius: float) -> float:
    """What a pixel spans at the far end of the ball in the farthest view: no pixel is larger."""
    return (np.linalg.norm(cameras.centers, axis=1).max() + radius) / cameras.K[0, 0, 0]


def rays(cameras: Cameras, view: int) -> np.ndarray:
    centers = pixel_centers(cameras.width, cameras.height)
    return ray_directions(centers, cameras.K[view], cameras.c2w[view])


def masks_of(mesh: trimesh.Trimesh, cameras: Cameras) -> np.ndarray:
    """True where the ray through a pixel's center meets the mesh."""
    scene = RaycastingScene(np.array(mesh.vertices, float), np.array(mesh.faces, np.int32))
    shape = cameras.height, cameras.width
    hits = [
        np.isfinite(scene.distance(cameras.centers[i][None], rays(cameras, i)))
        for i in range(len(cameras))
    ]
    return np.stack(hits).reshape(-1, *shape)


def masks_of_ball(radius: float, cameras: Cameras) -> np.ndarray:
    """The same for the ball about the origin, without a mesh."""
    shape = cameras.height, cameras.width
    passes = [
        np.linalg.norm(np.cross(rays(cameras, i), cameras.centers[i]), axis=1) < radius
        for i in range(len(cameras))
    ]
    return np.stack(passes).reshape(-1, *shape)


def hull_of_ball(directions: np.ndarray, radius: float, cameras: Cameras) -> np.ndarray:
    """Distance from the origin to the surface of the exact hull of the ball, in `directions`.

    A view at the distance D sees the cone that touches the ball at the angle acos(radius / D)
    from the eye's direction; in a plane through the axis it is a line `radius` from the origin.
    """
    distance = np.linalg.norm(cameras.centers, axis=1)
    angle = np.arccos(np.clip(directions @ (cameras.centers / distance[:, None]).T, -1, 1))
    cosine = np.cos(angle - np.arccos(radius / distance))
    return radius / np.where(cosine > 0, cosine, 0.01).max(axis=1)


def render_painted(
    mesh: trimesh.Trimesh, cameras: Cameras, paint: Callable[[np.ndarray], np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Depth (mm, 0: background), and color (white behind) of every pixel's center.

    `paint` takes points (n, 3) in mm to colors (n, 3) in [0, 255].
    """
    scene = RaycastingScene(np.array(mesh.vertices, float), np.array(mesh.faces, np.int32))
    depth = np.zeros((len(cameras), cameras.height * cameras.width), np.float32)
    rgb = np.full((*depth.shape, 3), 255, np.uint8)
    for i, camera_center in enumerate(cameras.centers):
        directions = rays(cameras, i)
        t = scene.distance(camera_center[None], directions)
        hit = np.isfinite(t)
        points = camera_center + t[hit, None] * directions[hit]
        depth[i, hit] = (points - camera_center) @ cameras.c2w[i, :3, 2]
        rgb[i, hit] = paint(points)
    shape = len(cameras), cameras.height, cameras.width
    return depth.reshape(shape), rgb.reshape(*shape, 3)


def cup(outer: float, inner: float, height: float, floor: float) -> trimesh.Trimesh:
    """A round cup about the origin, open towards +z, with a floor of the thickness `floor`."""
    profile = [
        [0, -height / 2],
        [outer, -height / 2],
        [outer, height / 2],
        [inner, height / 2],
        [inner, floor - height / 2],
        [0, floor - height / 2],
    ]
    return trimesh.creation.revolve(np.array(profile), sections=96)
