"""Where to look for the part: a ball that the cameras have in frame."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float

from industnerf.errors import BadArtifact, BadParams
from industnerf.geometry.cameras import Cameras, common_view_ball
from industnerf.reconstruct.conventions import CONVENTION_HINT, detect_convention_error
from industnerf.reconstruct.framing import MIN_AXIS_SPREAD, axis_spread, in_frame

CONVENTION_ERROR_SHARE = 0.9  # cameras that look away are no accident
REGION_HINT = (
    "state the region of interest as --center X Y Z --radius R, in the unit of the cameras"
)


def region_of_interest(
    cameras: Cameras,
    image_paths: Sequence[Path],
    center: tuple[float, float, float] | None,
    radius: float | None,
) -> tuple[Float[np.ndarray, "3"], float]:
    """Center and radius of the region of interest, in the unit of the cameras.

    What is not given is that of `framed_ball`.  Raises BadArtifact if the cameras do not look at
    a common point, if fewer than two have the given center in frame, or if one is in the ball.
    """
    if center is not None:
        if radius is None:
            raise BadParams("--center needs --radius beside it")
        ball_center = np.array(center, float)
        _check_given_center(cameras, ball_center)
    else:
        _check_axis_spread(cameras)
        ball_center, framed_radius = common_view_ball(cameras)
        _check_common_point(cameras, image_paths, ball_center)
        radius = framed_radius if radius is None else radius
    _check_cameras_outside(cameras, ball_center, radius)
    return ball_center, radius


def _check_given_center(cameras: Cameras, center: Float[np.ndarray, "3"]) -> None:
    num_visible = int(in_frame(cameras, center).sum())
    if num_visible < 2:
        remedy = detect_convention_error(cameras, center) or (
            f"is it in the frame and the unit of the cameras? If so, {CONVENTION_HINT}"
        )
        raise BadArtifact(
            f"{num_visible} of {len(cameras)} cameras have the given --center in frame, it takes 2: "
            f"{remedy}"
        )


def _check_cameras_outside(cameras: Cameras, center: Float[np.ndarray, "3"], radius: float) -> None:
    min_distance = float(np.linalg.norm(cameras.centers - center, axis=1).min())
    if radius >= min_distance:
        raise BadArtifact(
            f"the region of interest has a radius of {radius:g}, and a camera is {min_distance:g} from "
            "its center: is --radius in the unit of the cameras?"
        )


def _check_axis_spread(cameras: Cameras) -> None:
    """Axes that are all but parallel meet nowhere, or anywhere."""
    sine = axis_spread(cameras)
    if sine < np.sin(MIN_AXIS_SPREAD):
        raise BadArtifact(
            "the cameras do not look at a common point: their optical axes are parallel to "
            f"within {np.degrees(sine):.2g} degrees; {detect_convention_error(cameras, None) or REGION_HINT}"
        )


def _check_common_point(
    cameras: Cameras, image_paths: Sequence[Path], center: Float[np.ndarray, "3"]
) -> None:
    missing = np.flatnonzero(~in_frame(cameras, center))
    if len(missing):
        point = ", ".join(f"{x:.4g}" for x in center)
        raise BadArtifact(
            f"the cameras do not look at a common point: {len(missing)} of {len(cameras)}, the "
            f"first that of {image_paths[missing[0]]}, do not have ({point}) in frame, to which their "
            f"optical axes come nearest; {_suggest_fix(cameras, len(missing))}"
        )


def _suggest_fix(cameras: Cameras, num_missing: int) -> str:
    """What to do about `missing` of `cameras` that do not have the common point in frame."""
    if suspected_error := detect_convention_error(cameras, None):
        return suspected_error
    return CONVENTION_HINT if num_missing >= CONVENTION_ERROR_SHARE * len(cameras) else REGION_HINT
