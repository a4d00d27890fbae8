"""From a drawing to one closed, outward oriented surface mesh, in mm.

Each solid is meshed and welded by itself; solids that touch or overlap (a thread on its shank, a
ball in its race) are then united as meshes, so that no surface is left inside.
"""

from dataclasses import dataclass

import manifold3d
import numpy as np
from build123d import Shape, Solid
from jaxtyping import Float, Int32, UInt8

from industnerf.errors import BadPart
from industnerf.parts.catalogue.recipe import Assembly, MeshBoolean
from industnerf.parts.io.occt_triangulation import (
    ANGULAR_DEFLECTION,
    LINEAR_DEFLECTION,
    triangulate_shape,
)

SIMPLIFY_TOLERANCE = 5e-5  # share of the part's bounding-box diagonal
MIN_VOLUME = 1e-12  # share of the diagonal's cube


@dataclass(frozen=True)
class TessellatedDrawing:
    """A mesh, and which of the drawing's finishes each face has."""

    vertices: Float[np.ndarray, "n 3"]
    faces: Int32[np.ndarray, "m 3"]
    finish: UInt8[np.ndarray, "m"]  # an index into the keys of `Assembly.bodies`


def tessellate(drawing: Assembly, refinement: int = 1) -> TessellatedDrawing:
    """The closed surface of `drawing`, `refinement` times finer than the stored meshes.

    Raises `BadPart` if a face cannot be meshed or the solids do not unite to a manifold.
    """
    bodies = [_joined_and_cut(body) for body in drawing.bodies.values()]
    solids = [solid for join, _ in bodies for solid in join]
    if not solids:
        raise BadPart("the drawing holds no solid")
    tessellator = _Tessellator(_diagonal(solids), refinement)
    if single_solid(drawing) is not None:
        vertices, faces = tessellator.triangulate(solids[0])
        return TessellatedDrawing(vertices, faces, np.zeros(len(faces), np.uint8))
    originals = [tessellator.join_and_cut(join, cut) for join, cut in bodies]
    united = manifold3d.Manifold.batch_boolean(originals, manifold3d.OpType.Add)
    return tessellator.to_mesh(united, [original.original_id() for original in originals])


def single_solid(drawing: Assembly) -> Solid | None:
    """The one solid that the drawing is, or None: then its exact volume is not known."""
    (join, cut), *others = (_joined_and_cut(body) for body in drawing.bodies.values())
    return join[0] if len(join) == 1 and not cut and not others else None


def _joined_and_cut(body: Shape | MeshBoolean) -> tuple[list[Solid], list[Solid]]:
    join, cut = (body.join, body.cut) if isinstance(body, MeshBoolean) else ([body], [])
    return [s for shape in join for s in shape.solids()], [
        s for shape in cut for s in shape.solids()
    ]


def _diagonal(solids: list[Solid]) -> float:
    boxes = [solid.bounding_box() for solid in solids]
    low = np.min([tuple(box.min) for box in boxes], axis=0)
    high = np.max([tuple(box.max) for box in boxes], axis=0)
    return float(np.linalg.norm(high - low))


@dataclass(frozen=True)
class _Tessellator:
    diagonal: float  # mm, sets all tolerances
    refinement: int

    def triangulate(
        self, solid: Solid
    ) -> tuple[Float[np.ndarray, "n 3"], Int32[np.ndarray, "m 3"]]:
        # The chord error goes with the square of a facet's turn.
        linear_deflection_mm = LINEAR_DEFLECTION / self.refinement * self.diagonal
        angular_deflection = ANGULAR_DEFLECTION / self.refinement**0.5
        return triangulate_shape(
            solid.wrapped, linear_deflection_mm, angular_deflection, self.diagonal
        )

    def join_and_cut(self, join: list[Solid], cut: list[Solid]) -> manifold3d.Manifold:
        """What is joined less what is cut, as one original: its faces can be told from others'."""
        add = manifold3d.OpType.Add
        united = manifold3d.Manifold.batch_boolean([self.to_manifold(s) for s in join], add)
        if cut:
            united -= manifold3d.Manifold.batch_boolean([self.to_manifold(s) for s in cut], add)
        return united.as_original()

    def to_manifold(self, solid: Solid) -> manifold3d.Manifold:
        vertices, faces = self.triangulate(solid)
        mesh = manifold3d.Mesh64(vertices, np.ascontiguousarray(faces, dtype=np.uint64))
        body = manifold3d.Manifold(mesh)
        if body.status() != manifold3d.Error.NoError:
            center = tuple(round(x, 2) for x in solid.center())
            raise BadPart(
                f"the mesh of the solid near {center} mm is refused: {body.status().name}"
            )
        return body

    def to_mesh(self, united: manifold3d.Manifold, originals: list[int]) -> TessellatedDrawing:
        """The mesh of all that has volume, each face with the place of its body in `originals`."""
        # Surfaces that coincide can leave a film behind: a closed piece that holds nothing.
        pieces = united.simplify(SIMPLIFY_TOLERANCE / self.refinement * self.diagonal).decompose()
        solid_pieces = [p for p in pieces if abs(p.volume()) > MIN_VOLUME * self.diagonal**3]
        mesh = manifold3d.Manifold.compose(solid_pieces).to_mesh64()
        lengths = np.diff(np.asarray(mesh.run_index, np.int64)) // 3
        finish = np.repeat([originals.index(i) for i in mesh.run_original_id], lengths)
        vertices = mesh.vert_properties[:, :3].copy()
        return TessellatedDrawing(
            vertices, mesh.tri_verts.astype(np.int32), finish.astype(np.uint8)
        )
