"""Thumbnails of meshes for contact sheets and reports, never for an experiment."""

import numpy as np
from jaxtyping import Float, Int32, UInt8

from industnerf.geometry.raycast import RaycastingScene

TOWARDS_CAMERA = np.array([1.0, -1.2, 0.9])  # from the upper right
MARGIN = 0.04  # of the picture, left white on each side
SUPERSAMPLES = 2  # rays across a pixel, both ways
AMBIENT = 0.3
# (right, up, towards the camera) in the image, and intensity: one lamp to model, one to fill
LIGHTS = (((-0.5, 0.8, 0.6), 0.65), ((0.9, 0.1, 0.4), 0.2))


def render_thumbnail(
    vertices: Float[np.ndarray, "n 3"],
    faces: Int32[np.ndarray, "m 3"],
    albedo: Float[np.ndarray, "m 3"],
    size_px: int,
) -> UInt8[np.ndarray, "{size_px} {size_px} 3"]:
    """The mesh as large as the picture allows, seen in parallel projection, +z up, on white.

    `albedo` is linear, in [0, 1], and one color a face; light follows Lambert's law, a face is
    lit on the side that the viewer sees, and the picture is encoded in sRGB.
    """
    view = viewing_axes()
    projected = vertices @ view.T
    low, high = projected.min(axis=0), projected.max(axis=0)
    side = float((high - low)[:2].max()) / (1 - 2 * MARGIN)
    face = _first_hit_faces(
        RaycastingScene(vertices, faces), view, (low + high) / 2, high[2], side, size_px
    )
    background = np.ones((1, 3), np.float32)
    # face -1 is the background
    colors = np.concatenate([albedo * _face_irradiance(vertices, faces, view), background])
    linear = np.minimum(colors[face], 1).reshape(size_px, SUPERSAMPLES, size_px, SUPERSAMPLES, 3)
    return np.round(255 * _srgb(linear.mean(axis=(1, 3)))).astype(np.uint8)


def viewing_axes() -> Float[np.ndarray, "3 3"]:
    """Rows: right, up and towards the camera, in the world."""
    back = TOWARDS_CAMERA / np.linalg.norm(TOWARDS_CAMERA)
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(back, right), back])


def _first_hit_faces(
    scene: RaycastingScene,
    view: Float[np.ndarray, "3 3"],
    center: Float[np.ndarray, "3"],
    nearest: float,
    side: float,
    size_px: int,
) -> Int32[np.ndarray, "rays"]:
    """The face that each ray of a square grid of width `side` (mm) meets first, row by row."""
    rays = size_px * SUPERSAMPLES
    across = side * ((np.arange(rays) + 0.5) / rays - 0.5)
    x, y = np.meshgrid(center[0] + across, center[1] - across)
    starts = np.stack([x.ravel(), y.ravel(), np.full(rays * rays, nearest + side)], axis=1) @ view
    return scene.cast(starts, np.broadcast_to(-view[2], starts.shape)).face


def _face_irradiance(
    vertices: Float[np.ndarray, "n 3"],
    faces: Int32[np.ndarray, "m 3"],
    view: Float[np.ndarray, "3 3"],
) -> Float[np.ndarray, "m 1"]:
    """What falls on each face: ambient + sum of intensity * max(0, cosine)."""
    a, b, c = vertices[faces[:, 0]], vertices[faces[:, 1]], vertices[faces[:, 2]]
    normal = np.cross(b - a, c - a) @ view.T
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    normal /= np.where(length > 0, length, 1) * np.where(normal[:, 2:] < 0, -1, 1)
    light = np.full((len(faces), 1), AMBIENT)
    for towards, intensity in LIGHTS:
        light[:, 0] += intensity * np.maximum(normal @ (towards / np.linalg.norm(towards)), 0)
    return light


def _srgb(linear: Float[np.ndarray, "h w 3"]) -> Float[np.ndarray, "h w 3"]:
    """Encoded for a screen -- IEC 61966-2-1."""
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
