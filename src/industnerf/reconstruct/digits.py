"""Whether the files that are written have the digits for where the part is."""

import numpy as np
from jaxtyping import Float

from industnerf.errors import BadArtifact

FINEST = 1e-4  # of the region's radius: far below the errors of any method


def check_digits(centre: Float[np.ndarray, "3"], radius: float) -> None:
    """Raise BadArtifact if float32 is too coarse at the region's largest coordinate.

    Clouds and meshes are written so, and would lose their shape without a word.
    """
    largest = float(np.abs(centre).max()) + radius
    with np.errstate(over="ignore", invalid="ignore"):
        step = float(np.spacing(np.float32(largest)))
    if not step <= FINEST * radius:  # nor if it is inf or nan
        raise BadArtifact(
            f"the region of interest, of radius {radius:.3g}, has coordinates of up to "
            f"{largest:.3g}, where the numbers of the cloud (float32) are {step:.2g} apart, "
            f"{step / radius:.2g} of the radius; at most {FINEST:g} keeps its shape: move the "
            "origin of the frame near the part, subtracting one point from the positions of all "
            "cameras"
        )
