"""What is known of a mesh, whoever drew it."""

from dataclasses import dataclass

import numpy as np

from industnerf.artifacts.part import Mesh
from industnerf.errors import BadPart
from industnerf.geometry.raycast import RaycastingScene
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.geometry.visibility import area_samples, visible_from
from industnerf.parts.strata import measure_shape
from industnerf.parts.validation import checks

NUM_CAMERAS = 100  # on a dense sphere
CAMERA_DISTANCE = 2.0  # its radius, in diagonals
SIGNIFICANT_DIGITS = 10  # kept of a measure, so that files do not differ by the order of a sum


@dataclass(frozen=True)
class MeshProperties:
    """The facts that `Part` and the catalogue share; what they mean is said at `Part`."""

    extents_mm: tuple[float, float, float]
    area_mm2: float
    volume_mm3: float | None
    bodies: int
    faces: int
    euler_number: int
    visible_share: float
    hull_hidden_share: float
    strata: tuple[str, ...]

    @property
    def through_holes(self) -> int | None:
        """The genus, summed over the bodies; None where the mesh is not closed."""
        return None if self.volume_mm3 is None else self.bodies - self.euler_number // 2


def measure(mesh: Mesh) -> MeshProperties:
    """All facts of a mesh; raises `BadPart` if it has no area."""
    area = checks.area_mm2(mesh.vertices, mesh.faces)
    if not area > 0:
        raise BadPart(
            f"a mesh of {len(mesh.faces)} faces and no area is no part: all its faces are "
            "slivers without width. Export the solid again, or take the file out of parts.path."
        )
    is_closed = not len(checks.bad_edges(mesh.faces))
    x, y, z = (round_significant(float(side)) for side in checks.extents_mm(mesh.vertices))
    shape = measure_shape(mesh)
    return MeshProperties(
        extents_mm=(x, y, z),
        area_mm2=round_significant(area),
        volume_mm3=round_significant(checks.volume_mm3(mesh.vertices, mesh.faces))
        if is_closed
        else None,
        bodies=checks.count_bodies(mesh.faces),
        faces=len(mesh.faces),
        euler_number=checks.euler_number(mesh.faces),
        visible_share=visible_share(mesh),
        hull_hidden_share=shape.hull_hidden_share,
        strata=shape.strata,
    )


def round_significant(value: float) -> float:
    """To `SIGNIFICANT_DIGITS` digits, not decimals: a part may be a micrometer wide."""
    return float(f"{value:.{SIGNIFICANT_DIGITS}g}")


def visible_share(mesh: Mesh) -> float:
    """Share of the area seen from at least one of `NUM_CAMERAS` points on a sphere."""
    points, tolerance_mm = area_samples(mesh.vertices, mesh.faces)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    diagonal = float(np.linalg.norm(high - low))
    cameras = (low + high) / 2 + CAMERA_DISTANCE * diagonal * fibonacci_sphere(NUM_CAMERAS)
    return float(
        visible_from(
            RaycastingScene(mesh.vertices, mesh.faces), points, cameras, tolerance_mm
        ).mean()
    )
