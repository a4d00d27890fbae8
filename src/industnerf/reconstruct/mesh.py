"""The surface as triangles: where the method sees it from all of the cameras, joined and closed.

Depths of the finished field are fused as those of the final cloud are where R11 is `tsdf_fusion`.
"""

from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from jaxtyping import Float, Float32
from pykdtree.kdtree import KDTree

from industnerf.artifacts.ply import write_ply
from industnerf.errors import ReconstructionFailed
from industnerf.geometry.cameras import Cameras, reduced_size, unit_ball_projections
from industnerf.geometry.isosurface import isosurface
from industnerf.geometry.tsdf import fuse
from industnerf.reconstruct.images import scale_intrinsics

MAX_RENDER_SIZE = 256  # px, the longer side of what the cameras see: a pixel is about a cell
GRID_RES = 192  # cells along each side of the cube round the region of interest
TRUNCATION_CELLS = 3.0  # of signed distances, in cells
# nearer to a corner of the lattice, vertices are one in single precision
MIN_ABS_DISTANCE_CELLS = 0.01


def extract_mesh(
    result: Any, cameras: Cameras, center: Float[np.ndarray, "3"], radius: float
) -> trimesh.Trimesh:
    """What bounds all that the cameras do not see empty, in their frame and unit.

    A vertex has the color of the nearest point of the cloud.  Raises ReconstructionFailed if the
    cameras see no surface.
    """
    render_cameras = downscale_cameras(cameras)
    renderings = result.render_views(render_cameras, result.background)
    depth = np.where(renderings.foreground, renderings.depth_mm / np.float32(radius), np.float32(0))
    if not depth.any():
        raise ReconstructionFailed("no mesh: the cameras see no surface of what was learned")
    spacing = 2 / GRID_RES
    values = signed_distances(depth, unit_ball_projections(render_cameras, center, radius))
    vertices, faces = isosurface(values, 0.0, np.full(3, spacing / 2 - 1), spacing)
    if not len(faces):
        raise ReconstructionFailed(
            "no mesh: every cell is seen empty by some camera; all there is may be thinner than "
            f"a cell, {spacing * radius:.3g}"
        )
    world_vertices = center + radius * vertices
    _, nearest = KDTree(result.points.astype(np.float64)).query(world_vertices)
    colors = result.colors[nearest.astype(np.int64)]
    return trimesh.Trimesh(world_vertices, faces, vertex_colors=colors, process=False)


def downscale_cameras(cameras: Cameras) -> Cameras:
    """The same with smaller images."""
    old_size = cameras.width, cameras.height
    new_size = reduced_size(*old_size, MAX_RENDER_SIZE)
    return Cameras(scale_intrinsics(cameras.K, old_size, new_size), cameras.c2w, *new_size)


def signed_distances(
    depth: Float32[np.ndarray, "n h w"], projections: Float32[np.ndarray, "n 3 4"]
) -> Float32[np.ndarray, "r r r"]:
    """At the cells' centers, positive inside; beyond the region of interest all is empty."""
    spacing = 2 / GRID_RES
    values = fuse(depth, projections, GRID_RES, TRUNCATION_CELLS * spacing)
    return np.where(
        np.abs(values) < MIN_ABS_DISTANCE_CELLS * spacing,
        np.float32(-MIN_ABS_DISTANCE_CELLS * spacing),
        values,
    )


def export_mesh(path: Path, mesh: trimesh.Trimesh, suffix: str, unit: str) -> None:
    """Write `mesh` in the format of `suffix`; PLY and OBJ have its colors, STL cannot."""
    if suffix == ".ply":
        write_ply(
            path,
            mesh.vertices,
            colors=mesh.visual.vertex_colors[:, :3],
            faces=mesh.faces.astype(np.int32),
            unit=unit,
        )
    else:
        mesh.export(path, file_type=suffix[1:])
