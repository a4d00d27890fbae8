"""The surface as triangles: that of the method, or where it sees one from all of the cameras.

A method without a surface of its own has depths.  They are fused as those of the final cloud are
where R11 is `tsdf_fusion`.
"""

from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from jaxtyping import Float, Float32, Int32
from pykdtree.kdtree import KDTree

from industnerf.artifacts.ply import write_ply
from industnerf.errors import ReconstructionFailed
from industnerf.geometry.cameras import Cameras, reduced_size, unit_ball_projections
from industnerf.geometry.isosurface import isosurface, off_zero
from industnerf.geometry.tsdf import fuse
from industnerf.reconstruct.images import scale_intrinsics

MAX_RENDER_SIZE = 256  # px, the longer side of what the cameras see: a pixel is about a cell
GRID_RES = 192  # cells along each side of the cube round the region of interest
TRUNCATION_CELLS = 3.0  # of signed distances, in cells


def extract_mesh(
    result: Any, cameras: Cameras, center: Float[np.ndarray, "3"], radius: float
) -> trimesh.Trimesh:
    """The closed surface, in the frame and unit of the cameras.

    A vertex has the color of the nearest point of the cloud.  Raises ReconstructionFailed if there
    is no surface.
    """
    if result.mesh:
        vertices, faces = result.mesh()
    else:
        vertices, faces = fuse_depths(result, cameras, center, radius)
    if not len(faces):
        raise ReconstructionFailed("no mesh: there is no surface")
    _, nearest = KDTree(result.points.astype(np.float64)).query(vertices)
    colors = result.colors[nearest.astype(np.int64)]
    return trimesh.Trimesh(vertices, faces, vertex_colors=colors, process=False)


def fuse_depths(
    result: Any, cameras: Cameras, center: Float[np.ndarray, "3"], radius: float
) -> tuple[Float[np.ndarray, "v 3"], Int32[np.ndarray, "f 3"]]:
    """Vertices and faces of what bounds all that the cameras do not see empty.

    Raises ReconstructionFailed if the cameras see no surface.
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
    return center + radius * vertices, faces


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
    return spacing * off_zero(values / np.float32(spacing))


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
