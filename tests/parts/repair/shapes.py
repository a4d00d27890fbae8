"""Solids whose every number is known, and the defects that files add to them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import trimesh

from industnerf.artifacts.part import Mesh
from industnerf.config import load_params
from industnerf.parts.validation.checks import volume_mm3
from industnerf.schema import RepairParams

DEFAULTS = load_params(Path(__file__).parents[3] / "params.yaml").parts.repair


def settings(**changes: float | bool) -> RepairParams:
    """The cleaning that params.yaml asks for, but for `changes`."""
    return replace(DEFAULTS, **changes)


def box(sides=(30.0, 20.0, 10.0), center=(0.0, 0.0, 0.0), finish=0) -> Mesh:
    """12 faces, 8 vertices."""
    return _mesh(trimesh.creation.box(sides), center, finish)


def ball(radius=10.0, center=(0.0, 0.0, 0.0), finish=0, subdivisions=2) -> Mesh:
    """An icosphere, inscribed; 320 faces."""
    sphere = trimesh.creation.icosphere(subdivisions, radius)
    return _mesh(sphere, center, finish)


def tube(inner=5.0, outer=10.0, height=30.0) -> Mesh:
    """A surface of genus 1."""
    return _mesh(trimesh.creation.annulus(inner, outer, height, sections=24), (0, 0, 0), 0)


def _mesh(shape: trimesh.Trimesh, center, finish: int) -> Mesh:
    faces = np.asarray(shape.faces, np.int32)
    vertices = np.asarray(shape.vertices, np.float64) + center
    return Mesh(vertices, faces, np.full(len(faces), finish, np.uint8))


def concatenated(*meshes: Mesh) -> Mesh:
    """One mesh of several, as a file of one solid would hold them."""
    first = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    faces = [mesh.faces + offset for mesh, offset in zip(meshes, first, strict=True)]
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate(faces).astype(np.int32),
        np.concatenate([mesh.finish for mesh in meshes]),
    )


def flipped(mesh: Mesh, mask=slice(None)) -> Mesh:
    """Faces `which` wound the other way."""
    faces = mesh.faces.copy()
    faces[mask] = faces[mask, ::-1]
    return Mesh(mesh.vertices, faces, mesh.finish)


def triangle_soup(mesh: Mesh) -> Mesh:
    """Every triangle with corners of its own, as STL stores it."""
    faces = np.arange(3 * len(mesh.faces), dtype=np.int32).reshape(-1, 3)
    return Mesh(mesh.vertices[mesh.faces].reshape(-1, 3), faces, mesh.finish)


def select_faces(mesh: Mesh, mask) -> Mesh:
    """Some of the faces, in that order; all vertices."""
    return Mesh(mesh.vertices, mesh.faces[mask], mesh.finish[mask])


def scaled(mesh: Mesh, factor: float, shift=(0.0, 0.0, 0.0)) -> Mesh:
    return Mesh(mesh.vertices * factor + shift, mesh.faces, mesh.finish)


def volume(mesh: Mesh) -> float:
    return volume_mm3(mesh.vertices, mesh.faces)
