"""Whether the files that are written have the digits for where the part is."""

import numpy as np
from jaxtyping import Float

from industnerf.errors import BadArtifact

MAX_RELATIVE_SPACING = 1e-4  # of the region's radius: far below the errors of any method


def check_float32_precision(center: Float[np.ndarray, "3"], radius: float) -> None:
    """Raise BadArtifact if float32 is too coarse at the region's largest coordinate.

    Clouds and meshes are written so, and would lose their shape without a word.
    """
    max_coordinate = float(np.abs(center).max()) + radius
    with np.errstate(over="ignore", invalid="ignore"):
        spacing = float(np.spacing(np.float32(max_coordinate)))
    if not spacing <= MAX_RELATIVE_SPACING * radius:  # nor if it is inf or nan
        raise BadArtifact(
            f"the region of interest, of radius {radius:.3g}, has coordinates of up to "
            f"{max_coordinate:.3g}, where the numbers of the cloud (float32) are {spacing:.2g} apart, "
            f"{spacing / radius:.2g} of the radius; at most {MAX_RELATIVE_SPACING:g} keeps its shape: move the "
            "origin of the frame near the part, subtracting one point from the positions of all "
            "cameras"
        )
