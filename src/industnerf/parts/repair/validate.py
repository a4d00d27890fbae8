"""What cannot be a part."""

import numpy as np

from industnerf.artifacts.part import Mesh
from industnerf.errors import BadPart
from industnerf.parts.validation.checks import area_mm2

MIN_FACES = 2  # a single triangle is no part; two make a sheet, and four a solid
MIN_AREA = 1e-6  # area in squared diagonals: a ribbon so narrow is a line to any camera


def require_surface(solids: list[Mesh]) -> None:
    """Raise BadPart unless `solids`, in the unit frame, hold a surface that can be seen."""
    faces = sum(len(solid.faces) for solid in solids)
    if faces < MIN_FACES:
        raise BadPart(f"it has {faces} sound face, and no part has fewer than {MIN_FACES}")
    area = sum(area_mm2(solid.vertices, solid.faces) for solid in solids)
    if area < MIN_AREA:
        raise BadPart(
            f"its {faces} faces lie on a line: their area is {area:.1e} of the squared diagonal"
        )
    if not np.isfinite(area):
        raise BadPart("its area is not finite")
