"""From what a net says in the unit cube, once a view or once for all, to a reconstruction."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.state import State
from industnerf.errors import ReconstructionFailed
from industnerf.geometry.boxes import Cube
from industnerf.methods.base import Reconstruction


def answered(
    clouds: Sequence[Float[np.ndarray, "_ 3"]], frame: Cube, state: State
) -> Reconstruction:
    """One or several answers in the unit cube of `frame`; their score is the mean.

    The empty ones come last: the first, which stands for all in pictures, has points.
    Raises ReconstructionFailed if every one of them is empty.
    """
    full = [points for points in clouds if len(points)]
    if not full:
        raise ReconstructionFailed(
            f"all {len(clouds)} answers of the net are empty: it sees matter nowhere, above its "
            "`threshold`"
        )
    empty = [points for points in clouds if not len(points)]
    first, *others = [frame.to_mm(points) for points in (*full, *empty)]
    trained = {"parameters": state.parameters, "steps": state.steps}
    return Reconstruction(first, others_mm=tuple(others), **trained)
