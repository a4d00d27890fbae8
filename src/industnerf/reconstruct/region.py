"""Where to look for the part: a ball that the cameras have in frame."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float

from industnerf.errors import BadArtifact, BadParams
from industnerf.geometry.cameras import Cameras, framed_ball
from industnerf.reconstruct.conventions import ASKED, likely_mistake
from industnerf.reconstruct.framing import SAME_WAY, in_frame, spread

NEARLY_ALL = 0.9  # cameras that look away are no accident
REMEDY = "state the region of interest as --centre X Y Z --radius R, in the unit of the cameras"


def region(
    cameras: Cameras,
    photos: Sequence[Path],
    centre: tuple[float, float, float] | None,
    radius: float | None,
) -> tuple[Float[np.ndarray, "3"], float]:
    """Centre and radius of the region of interest, in the unit of the cameras.

    What is not given is that of `framed_ball`.  Raises BadArtifact if the cameras do not look at
    a common point, if fewer than two have the given centre in frame, or if one is in the ball.
    """
    if centre is not None:
        if radius is None:
            raise BadParams("--centre needs --radius beside it")
        middle = np.array(centre, float)
        _check_given(cameras, middle)
    else:
        _check_spread(cameras)
        middle, framed = framed_ball(cameras)
        _check_common(cameras, photos, middle)
        radius = framed if radius is None else radius
    _check_outside(cameras, middle, radius)
    return middle, radius


def _check_given(cameras: Cameras, centre: Float[np.ndarray, "3"]) -> None:
    seen = int(in_frame(cameras, centre).sum())
    if seen < 2:
        remedy = likely_mistake(cameras, centre) or (
            f"is it in the frame and the unit of the cameras? If so, {ASKED}"
        )
        raise BadArtifact(
            f"{seen} of {len(cameras)} cameras have the given --centre in frame, it takes 2: "
            f"{remedy}"
        )


def _check_outside(cameras: Cameras, centre: Float[np.ndarray, "3"], radius: float) -> None:
    nearest = float(np.linalg.norm(cameras.eyes - centre, axis=1).min())
    if radius >= nearest:
        raise BadArtifact(
            f"the region of interest has a radius of {radius:g}, and a camera is {nearest:g} from "
            "its centre: is --radius in the unit of the cameras?"
        )


def _check_spread(cameras: Cameras) -> None:
    """Axes that are all but parallel meet nowhere, or anywhere."""
    sine = spread(cameras)
    if sine < np.sin(SAME_WAY):
        raise BadArtifact(
            "the cameras do not look at a common point: their optical axes are parallel to "
            f"within {np.degrees(sine):.2g} degrees; {likely_mistake(cameras, None) or REMEDY}"
        )


def _check_common(cameras: Cameras, photos: Sequence[Path], centre: Float[np.ndarray, "3"]) -> None:
    missing = np.flatnonzero(~in_frame(cameras, centre))
    if len(missing):
        point = ", ".join(f"{x:.4g}" for x in centre)
        raise BadArtifact(
            f"the cameras do not look at a common point: {len(missing)} of {len(cameras)}, the "
            f"first that of {photos[missing[0]]}, do not have ({point}) in frame, to which their "
            f"optical axes come nearest; {_remedy(cameras, len(missing))}"
        )


def _remedy(cameras: Cameras, missing: int) -> str:
    """What to do about `missing` of `cameras` that do not have the common point in frame."""
    if mistake := likely_mistake(cameras, None):
        return mistake
    return ASKED if missing >= NEARLY_ALL * len(cameras) else REMEDY
