"""Closed meshes of simple solids, in mm, their axis along z and their middle at the origin."""

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

from industnerf.artifacts.part import Mesh

GENERIC_ROTATION = Rotation.from_euler(
    "xyz", [0.4, -1.1, 2.3]
).as_matrix()  # no axis lies along another


def from_trimesh(mesh: trimesh.Trimesh) -> Mesh:
    return Mesh.with_one_appearance(np.array(mesh.vertices, float), np.array(mesh.faces, np.int32))


def box(x: float, y: float, z: float) -> Mesh:
    return from_trimesh(trimesh.creation.box((x, y, z)))


def ball(radius: float, subdivisions: int = 4) -> Mesh:
    return from_trimesh(trimesh.creation.icosphere(subdivisions, radius))


def prism(sides: int, radius: float, height: float) -> Mesh:
    """Over a regular polygon whose corners lie on the circle of `radius`."""
    return from_trimesh(trimesh.creation.cylinder(radius, height, sections=sides))


def tube(inner: float, outer: float, length: float, sections: int = 64) -> Mesh:
    return from_trimesh(trimesh.creation.annulus(inner, outer, length, sections=sections))


def torus(major: float, minor: float, sections: int = 64) -> Mesh:
    return from_trimesh(
        trimesh.creation.torus(major, minor, major_sections=sections, minor_sections=sections)
    )


def cup(inner: float, outer: float, floor: float, height: float, sections: int = 64) -> Mesh:
    """A tube with a floor `floor` mm thick, open at the top."""
    outline = [(0, 0), (outer, 0), (outer, height), (inner, height), (inner, floor), (0, floor)]
    revolved = trimesh.creation.revolve(np.array(outline, float), sections=sections)
    revolved.vertices -= [0, 0, height / 2]
    return from_trimesh(revolved)


def combine_meshes(*meshes: Mesh) -> Mesh:
    """Several meshes as one, nothing merged."""
    starts = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes[:-1]])
    faces = [mesh.faces + start for mesh, start in zip(meshes, starts, strict=True)]
    vertices = np.concatenate([mesh.vertices for mesh in meshes])
    return Mesh.with_one_appearance(vertices, np.concatenate(faces).astype(np.int32))


def transform_mesh(
    mesh: Mesh, scale: float = 1.0, rotation: np.ndarray | None = None, offset=(0, 0, 0)
) -> Mesh:
    """Turned, then scaled, then shifted."""
    rotated = mesh.vertices if rotation is None else mesh.vertices @ rotation.T
    return Mesh(scale * rotated + np.array(offset, float), mesh.faces, mesh.finish)


def bow_tie() -> Mesh:
    """A prism over an outline that crosses itself: closed, yet one of its lobes is inside out."""
    outline = np.array([[4, -3], [4, 3], [0, 0], [-2, -1.5], [-2, 1.5], [0, 0]], dtype=np.float64)
    vertices = np.concatenate([np.c_[outline, np.full(6, z)] for z in (0.0, 1.0)])
    top = [(0, 1, 2), (0, 2, 5), (2, 3, 4), (2, 4, 5)]
    faces = [(a + 6, b + 6, c + 6) for a, b, c in top] + [(c, b, a) for a, b, c in top]
    for a, b in zip(range(6), [1, 2, 3, 4, 5, 0], strict=True):
        faces += [(a, b, b + 6), (a, b + 6, a + 6)]
    return Mesh.with_one_appearance(vertices, np.array(faces, np.int32))
