"""The lit surface of a part: how much light it sends along a ray.

Lights are fixed to the part and the material is matte, so a point is as bright from every side
that sees it (photo-consistency).  A face is lit on the side that the viewer sees.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float32, Int

from industnerf.artifacts.part import Mesh
from industnerf.capture.edges import BACKGROUND
from industnerf.capture.normals import corner_normals, face_normals
from industnerf.geometry.raycast import Scene
from industnerf.schema import LightParams


@dataclass(frozen=True)
class Seen:
    """What the rays that hit the part show."""

    ray: Int[np.ndarray, "hits"]  # which rays
    t: Float32[np.ndarray, "hits"]  # in lengths of their directions
    light: Float32[np.ndarray, "hits"]  # times albedo = radiance


class Surface:
    """A mesh under lamps, ready to be looked at from anywhere."""

    def __init__(self, mesh: Mesh, crease_deg: float, light: LightParams) -> None:
        self.vertices, triangles = mesh.vertices, mesh.triangles
        self._scene = Scene(mesh.vertices, mesh.faces)
        self._lamps = Lamps.of(light)
        self._facing = face_normals(triangles)
        self._offset = np.einsum("ij,ij->i", self._facing, triangles[:, 0])
        # n(u, v) = n0 + u (n1 - n0) + v (n2 - n0): for each axis n0 and the two differences
        normals = corner_normals(mesh.vertices, mesh.faces, crease_deg)
        normals[:, 1:] -= normals[:, :1]
        self._normals = np.ascontiguousarray(normals.transpose(2, 1, 0))

    def look(self, eye: Float[np.ndarray, "3"], directions: Float32[np.ndarray, "rays 3"]) -> Seen:
        """What the rays from `eye` show."""
        hits = self._scene.cast(eye[None], directions)
        ray = np.flatnonzero(hits.face >= 0)
        face, (u, v) = hits.face.take(ray), hits.uv.take(ray, axis=0).T
        normal = np.empty((3, len(ray)), np.float32)
        for axis, (n, du, dv) in enumerate(self._normals):
            normal[axis] = n.take(face) + u * du.take(face) + v * dv.take(face)
        normal[:, (self._facing @ eye < self._offset).take(face)] *= -1
        return Seen(ray, hits.t.take(ray), self._lamps.shine(normal))

    def light_along(
        self, eye: Float[np.ndarray, "3"], directions: Float32[np.ndarray, "rays 3"]
    ) -> Float32[np.ndarray, "rays"]:
        """The light that the rays from `eye` show, or BACKGROUND."""
        seen = self.look(eye, directions)
        light = np.full(len(directions), BACKGROUND)
        light[seen.ray] = seen.light
        return light


@dataclass(frozen=True)
class Lamps:
    """Ambient light and distant lamps."""

    ambient: np.float32
    towards: Float32[np.ndarray, "lamps 3"]  # unit
    intensity: Float32[np.ndarray, "lamps"]

    @staticmethod
    def of(light: LightParams) -> "Lamps":
        """`light` as arrays."""
        towards = np.array(light.directions, np.float32).reshape(-1, 3)
        towards /= np.linalg.norm(towards, axis=1, keepdims=True)
        return Lamps(np.float32(light.ambient), towards, np.array(light.intensities, np.float32))

    def shine(self, normals: Float32[np.ndarray, "3 n"]) -> Float32[np.ndarray, "n"]:
        """Lambert's law: ambient + sum of intensity * max(0, cosine); normals of any length."""
        length = np.sqrt(np.einsum("ij,ij->j", normals, normals))
        lit = self.intensity @ np.maximum(self.towards @ normals, 0)
        return np.maximum(self.ambient + lit / np.maximum(length, np.float32(1e-12)), 0)
