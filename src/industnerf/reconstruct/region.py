"""Where to look for the part: a ball that the cameras have in frame."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.views import OPENGL
from industnerf.errors import BadArtifact, BadParams
from industnerf.geometry.cameras import Cameras, common_view_ball
from industnerf.reconstruct.pose_outliers import in_frame, odd_cameras, odd_cameras_error

CONVENTION_ERROR_SHARE = 0.9  # cameras that look away are no accident
REGION_HINT = (
    "state the region of interest as --center X Y Z --radius R, in the unit of the cameras"
)


def region_of_interest(
    cameras: Cameras,
    names: Sequence[str],
    center: tuple[float, float, float] | None,
    radius: float | None,
) -> tuple[Float[np.ndarray, "3"], float]:
    """Center and radius of the region of interest, in the unit of the cameras.

    What is not given is that of `common_view_ball`; `names` are those of the frames.  Raises
    BadArtifact if the cameras do not look at a common point, if fewer than two have the given
    center in frame, or if one is in the ball.
    """
    if center is not None:
        if radius is None:
            raise BadParams("--center needs --radius beside it")
        ball_center = np.array(center, float)
        _check_given_center(cameras, ball_center)
    else:
        _check_axis_spread(cameras)
        ball_center, framed_radius = common_view_ball(cameras)
        _check_common_point(cameras, names, ball_center)
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
            f"{num_visible} of {len(cameras)} cameras have the given --center in frame, it takes "
            f"2: {remedy}"
        )


def _check_cameras_outside(cameras: Cameras, center: Float[np.ndarray, "3"], radius: float) -> None:
    min_distance = float(np.linalg.norm(cameras.centers - center, axis=1).min())
    if radius >= min_distance:
        raise BadArtifact(
            f"the region of interest has a radius of {radius:g}, and a camera is {min_distance:g} "
            "from its center: is --radius in the unit of the cameras?"
        )


def _check_axis_spread(cameras: Cameras) -> None:
    """Axes that are all but parallel meet nowhere, or anywhere."""
    sine = axis_spread(cameras)
    if sine < np.sin(MIN_AXIS_SPREAD):
        raise BadArtifact(
            "the cameras do not look at a common point: their optical axes are parallel to "
            f"within {np.degrees(sine):.2g} degrees; "
            f"{detect_convention_error(cameras, None) or REGION_HINT}"
        )


def _check_common_point(
    cameras: Cameras, names: Sequence[str], center: Float[np.ndarray, "3"]
) -> None:
    missing = np.flatnonzero(~in_frame(cameras, center))
    if len(missing):
        if odd := odd_cameras(cameras):
            raise BadArtifact(odd_cameras_error(cameras, names, odd))
        point = ", ".join(f"{x:.4g}" for x in center)
        raise BadArtifact(
            f"the cameras do not look at a common point: {len(missing)} of {len(cameras)}, the "
            f"first that of {names[missing[0]]}, do not have ({point}) in frame, to which "
            f"their optical axes come nearest; {_suggest_fix(cameras, len(missing))}"
        )


def _suggest_fix(cameras: Cameras, num_missing: int) -> str:
    """What to do about `num_missing` cameras that do not have the common point in frame."""
    if suspected_error := detect_convention_error(cameras, None):
        return suspected_error
    return CONVENTION_HINT if num_missing >= CONVENTION_ERROR_SHARE * len(cameras) else REGION_HINT


MIN_AXIS_SPREAD = np.radians(2.0)  # optical axes that spread less give no point where they meet


def axis_spread(cameras: Cameras) -> float:
    """Sine (r.m.s.) of the angles between the optical axes and the direction nearest to all."""
    axes = cameras.c2w[:, :3, 2]
    # 1 - the largest eigenvalue of the mean of a a^T: the mean squared sine to one direction
    mean_squared_sine = 1 - float(np.linalg.eigvalsh(axes.T @ axes / len(axes))[-1])
    return float(np.sqrt(max(mean_squared_sine, 0.0)))


Matrices = Float[np.ndarray, "n 4 4"]

# of matrices as a file has them: our axes are OpenCV's, and its are presumed to be OpenGL's
CONVENTIONS: dict[str, Callable[[Matrices], Matrices]] = {
    "have OpenCV's axes (y down, z forwards): negate the second and third column of each": (
        lambda matrices: matrices
    ),
    "are world-to-camera: invert each": lambda matrices: np.linalg.inv(matrices) @ OPENGL,
    "are world-to-camera with OpenCV's axes, as COLMAP's are: invert each, then negate its second "
    "and third column": np.linalg.inv,
}
CONVENTION_HINT = (
    "are the matrices camera-to-world, with OpenGL's axes (x to the right, y up, z backwards), "
    "and in one frame and unit?"
)


def detect_convention_error(cameras: Cameras, center: Float[np.ndarray, "3"] | None) -> str | None:
    """What the matrices look like, if all of `cameras` then have the point in frame; else None.

    The point is `center`, or where the optical axes come nearest to each other.  Cameras that have
    such a point in frame as they are look like nothing else, wherever `center` is.
    """
    if _all_have_in_frame(cameras, None):
        return None
    for description, convert in CONVENTIONS.items():
        reinterpreted = replace(cameras, c2w=convert(cameras.c2w @ OPENGL))
        if _all_have_in_frame(reinterpreted, center):
            return f"it looks as if the matrices {description}; then all have one point in frame"
    return None


def _all_have_in_frame(cameras: Cameras, center: Float[np.ndarray, "3"] | None) -> bool:
    if center is None:
        if axis_spread(cameras) < np.sin(MIN_AXIS_SPREAD):
            return False
        center = common_view_ball(cameras)[0]
    return bool(in_frame(cameras, center).all())


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
            f"{max_coordinate:.3g}, where the numbers of the cloud (float32) are {spacing:.2g} "
            f"apart, {spacing / radius:.2g} of the radius; at most {MAX_RELATIVE_SPACING:g} keeps "
            "its shape: move the origin of the frame near the part, subtracting one point from "
            "the positions of all cameras"
        )
