"""From predictions in the unit cube, one a view or one for all, to a reconstruction."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.state import ModelState
from industnerf.errors import ReconstructionFailed
from industnerf.geometry.bounding_cube import BoundingCube
from industnerf.methods.base import Reconstruction


def predictions_to_reconstruction(
    clouds: Sequence[Float[np.ndarray, "_ 3"]], part_frame: BoundingCube, state: ModelState
) -> Reconstruction:
    """One or several predictions in the unit cube of `part_frame`; their score is the mean.

    The empty ones come last: the first, which figures show, has points.
    Raises ReconstructionFailed if every one of them is empty.
    """
    non_empty = [points for points in clouds if len(points)]
    if not non_empty:
        raise ReconstructionFailed(
            f"all {len(clouds)} predictions of the network are empty: "
            "it has the same occupancy everywhere"
        )
    empty = [points for points in clouds if not len(points)]
    first, *others = [part_frame.to_mm(points) for points in (*non_empty, *empty)]
    trained = {"num_parameters": state.num_parameters, "steps": state.steps}
    return Reconstruction(first, extra_clouds_mm=tuple(others), **trained)
