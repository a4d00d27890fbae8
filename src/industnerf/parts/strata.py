"""Kinds of parts on which methods differ, each a formula on the mesh alone.

They were written down, thresholds and all, before any reconstruction was looked at.  Lengths are
shares of the diagonal of the bounding box.  `NUM_SAMPLES` points, uniform over the area and drawn
with a fixed seed, stand for the surface: a share of 5 % has a standard error of 0.34 %.

thin         Median over the area of the distance from the surface, straight inwards, to the
             opposite wall: less than `MAX_THIN_THICKNESS`.  A point with no opposite wall, as on an
             open sheet, counts 0.
holes        At least one through hole: genus = pieces of surface - Euler number / 2 >= 1, if the
             surface is closed.  An open one has none.
pockets      At least `MIN_POCKET_SHARE` of the area lies deeper than `MIN_POCKET_DEPTH` beneath the
             hull of infinitely many silhouettes (geometry/visual_hull.py): no number of silhouettes
             shows it.
symmetric    For some k >= 3, each rotation by a multiple of 1/k of a turn about one axis through
             the centroid takes at least `MIN_SYMMETRIC_SHARE` of the area to within
             `SYMMETRY_TOLERANCE` of the surface (geometry/symmetry.py, which also covers
             cubes, balls and needles).
multi-body   At least two solids: pieces of surface that share no vertex; in a closed mesh, a piece
             of negative volume is a cavity and does not count.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.part import Mesh
from industnerf.geometry.raycast import RaycastingScene
from industnerf.geometry.sampling import sample_surface
from industnerf.geometry.symmetry import rotation_order
from industnerf.geometry.visual_hull import is_on_visual_hull
from industnerf.parts.validation import checks
from industnerf.seeds import generator

NUM_SAMPLES = 4096
MAX_THIN_THICKNESS = 0.02
MIN_POCKET_DEPTH = 2e-3
MIN_POCKET_SHARE = 0.05
SYMMETRY_TOLERANCE = 5e-3
MIN_SYMMETRIC_SHARE = 0.99
STRATUM_DEFINITIONS = {
    "thin": f"median wall thickness below {100 * MAX_THIN_THICKNESS:.0f} % of the bounding "
    "box's diagonal",
    "holes": "at least one through hole (genus, from the Euler number)",
    "pockets": f"at least {100 * MIN_POCKET_SHARE:.0f} % of the area deeper than "
    f"{100 * MIN_POCKET_DEPTH:.1f} % of the diagonal beneath the hull of infinitely many "
    "silhouettes",
    "symmetric": "for some k >= 3, every rotation by a multiple of 1/k of a turn about one axis "
    f"takes {100 * MIN_SYMMETRIC_SHARE:.0f} % of the area to within "
    f"{100 * SYMMETRY_TOLERANCE:.1f} % of the diagonal of the surface",
    "multi-body": "at least two solids",
}


@dataclass(frozen=True)
class ShapeProperties:
    """What the strata are made of."""

    thickness: float  # median, in diagonals
    through_holes: int
    hull_hidden_share: float  # of the area: what no silhouette shows
    rotation_order: int | None  # of a symmetry, 3 or more
    solids: int

    @property
    def strata(self) -> tuple[str, ...]:
        """The strata that the part is in, in the order of FORMULAS."""
        is_member = {
            "thin": self.thickness < MAX_THIN_THICKNESS,
            "holes": self.through_holes >= 1,
            "pockets": self.hull_hidden_share >= MIN_POCKET_SHARE,
            "symmetric": self.rotation_order is not None,
            "multi-body": self.solids >= 2,
        }
        return tuple(name for name in STRATUM_DEFINITIONS if is_member[name])


def measure_shape(mesh: Mesh) -> ShapeProperties:
    """Measure `mesh`; raises ValueError if it has no area."""
    rng = generator(0, "strata")
    points, face = sample_surface(mesh.vertices, mesh.faces, NUM_SAMPLES, rng)
    normals = checks.double_area_normals(mesh.vertices, mesh.faces)[face]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    scene = RaycastingScene(mesh.vertices, mesh.faces)
    diagonal = float(np.linalg.norm(checks.extents_mm(mesh.vertices)))
    return ShapeProperties(
        thickness=float(np.median(thickness_mm(scene, points, normals, diagonal))) / diagonal,
        through_holes=checks.through_holes(mesh.faces),
        hull_hidden_share=1
        - float(is_on_visual_hull(scene, points, normals, MIN_POCKET_DEPTH * diagonal, rng).mean()),
        rotation_order=rotation_order(
            mesh.vertices,
            mesh.faces,
            scene,
            points,
            SYMMETRY_TOLERANCE * diagonal,
            MIN_SYMMETRIC_SHARE,
        ),
        solids=checks.count_solids(mesh.vertices, mesh.faces),
    )


def thickness_mm(
    scene: RaycastingScene,
    points: Float[np.ndarray, "n 3"],
    normals: Float[np.ndarray, "n 3"],
    diagonal_mm: float,
) -> Float[np.ndarray, "n"]:
    """From each point against its outward normal to the next wall; 0 where there is none."""
    offset = 1e-5 * diagonal_mm  # beneath the surface, so that it is not met itself
    distances = offset + scene.distance(points - offset * normals, -normals).astype(np.float64)
    return np.where(np.isfinite(distances), distances, 0)
