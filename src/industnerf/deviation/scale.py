"""Whether a cloud is as large as its CAD file, and in which unit it would be."""

import numpy as np

from industnerf.deviation.registration import Registration, free_scale
from industnerf.deviation.surface import Surface
from industnerf.errors import BadParams
from industnerf.parts.io.units import MM_PER_UNIT

SIZE_RATIO_RANGE = (0.5, 2.0)  # of the spreads; a part of a scan may be smaller
SCALE_ERROR = 0.003  # of a free scale, that is remarked on where it fits better:
BETTER = 0.9  # times the mean distance


def require_size(ratio: float) -> None:
    """Raise BadParams if the cloud is `ratio` times as large as the part, and that is odd."""
    if SIZE_RATIO_RANGE[0] < ratio < SIZE_RATIO_RANGE[1]:
        return
    units = [
        f"--units {name}"
        for name, mm in MM_PER_UNIT.items()
        if mm != 1 and SIZE_RATIO_RANGE[0] < ratio * mm < SIZE_RATIO_RANGE[1]
    ]
    hint = f"{' or '.join(units)} if its numbers are such; " if units else ""
    raise BadParams(
        f"the cloud is {ratio:.3g} times as large as the part, if its numbers are mm: {hint}"
        "--with-scale if its unit is arbitrary, as that of COLMAP"
    )


def scale_warning(points: np.ndarray, surface: Surface, registration: Registration) -> str:
    """What a free scale would be, where the cloud then fits better; else empty."""
    scale, cost = free_scale(points, surface, registration.move)
    if abs(scale - 1) < SCALE_ERROR or cost > BETTER * registration.cost:
        return ""
    return (
        f"it would fit better if it were {scale:.4g} times as large: check the known length that "
        "set its scale, or leave the scale free by --with-scale"
    )
