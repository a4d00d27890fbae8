"""The surface as triangles: where the method sees it from all of the cameras, joined and closed.

Depths of the finished field are fused as those of the final cloud are where R11 is `fused`.
"""

from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from jaxtyping import Float, Float32
from pykdtree.kdtree import KDTree

from industnerf.artifacts.ply import write_ply
from industnerf.errors import ReconstructionFailed
from industnerf.geometry.cameras import Cameras, projections_from_ball, reduced_size
from industnerf.geometry.fusion import fuse
from industnerf.geometry.isosurface import isosurface
from industnerf.reconstruct.views import scaled

LONGEST = 256  # px, the longer side of what the cameras see: a pixel is about a cell
GRID_RES = 192  # cells along each side of the cube round the region of interest
TRUNCATION = 3.0  # of signed distances, in cells
LEAST = 0.01  # the same: nearer to a corner of the lattice, vertices are one in single precision


def surface(
    outcome: Any, cameras: Cameras, centre: Float[np.ndarray, "3"], radius: float
) -> trimesh.Trimesh:
    """What bounds all that the cameras do not see empty, in their frame and unit.

    A vertex has the colour of the nearest point of the cloud.  Raises ReconstructionFailed if the
    cameras see no surface.
    """
    seen_from = smaller(cameras)
    seen = outcome.pictures(seen_from, outcome.background)
    depth = np.where(seen.foreground, seen.depth_mm / np.float32(radius), np.float32(0))
    if not depth.any():
        raise ReconstructionFailed("no mesh: the cameras see no surface of what was learned")
    spacing = 2 / GRID_RES
    values = signed_distances(depth, projections_from_ball(seen_from, centre, radius))
    vertices, faces = isosurface(values, 0.0, np.full(3, spacing / 2 - 1), spacing)
    if not len(faces):
        raise ReconstructionFailed(
            "no mesh: every cell is seen empty by some camera; all there is may be thinner than "
            f"a cell, {spacing * radius:.3g}"
        )
    placed = centre + radius * vertices
    _, nearest = KDTree(outcome.points.astype(np.float64)).query(placed)
    colours = outcome.colours[nearest.astype(np.int64)]
    return trimesh.Trimesh(placed, faces, vertex_colors=colours, process=False)


def smaller(cameras: Cameras) -> Cameras:
    """The same with smaller images."""
    old = cameras.width, cameras.height
    new = reduced_size(*old, LONGEST)
    return Cameras(scaled(cameras.K, old, new), cameras.c2w, *new)


def signed_distances(
    depth: Float32[np.ndarray, "n h w"], projections: Float32[np.ndarray, "n 3 4"]
) -> Float32[np.ndarray, "r r r"]:
    """At the cells' centres, positive inside; beyond the region of interest all is empty."""
    spacing = 2 / GRID_RES
    values = fuse(depth, projections, GRID_RES, TRUNCATION * spacing)
    return np.where(np.abs(values) < LEAST * spacing, np.float32(-LEAST * spacing), values)


def write(path: Path, mesh: trimesh.Trimesh, form: str) -> None:
    """Write `mesh` as `form`, the ending of a file; PLY and OBJ have its colours, STL cannot."""
    if form == ".ply":
        write_ply(
            path,
            mesh.vertices,
            colours=mesh.visual.vertex_colors[:, :3],
            faces=mesh.faces.astype(np.int32),
            unit="the cameras' unit",
        )
    else:
        mesh.export(path, file_type=form[1:])
