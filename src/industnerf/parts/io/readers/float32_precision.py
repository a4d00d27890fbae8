"""Whether coordinates that were kept as 32-bit numbers still hold the shape.

Such a number has 24 bits, so a part far from the origin loses the fine ones: at 10^7 mm from it
corners stand 1 mm apart or not at all.  Above a step of 10^-4 of the diagonal, a fifth of the chord
error of our own meshes, it shows and is remarked.  Above 10^-2, where a vertex is off by as much
as the F-score forgives, every number of the study would be about the rounding: refused.
"""

import numpy as np

from industnerf.errors import BadPart
from industnerf.parts.io.readers.mesh_content import MeshBody

WARN_STEP, MAX_STEP = 1e-4, 1e-2  # step of the coordinates, as a share of the diagonal


def precision_warnings(bodies: tuple[MeshBody, ...]) -> tuple[str, ...]:
    """A remark if the step of the coordinates shows; raises BadPart if it has eaten the shape."""
    points = np.concatenate([body.vertices for body in bodies])
    points = points[np.isfinite(points).all(axis=1)]
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0))) if len(points) else 0.0
    if diagonal == 0:
        return ()  # no solid anyway, which cleaning says
    largest = float(np.abs(points).max())
    share = float(np.spacing(np.float32(largest))) / diagonal
    message = (
        f"its 32-bit coordinates reach {largest:.3g}, where they step by {share:.2g} of the part's "
        "diagonal"
    )
    if share > MAX_STEP:
        raise BadPart(f"{message}: the shape is lost; export it near the origin")
    return (message,) if share > WARN_STEP else ()
