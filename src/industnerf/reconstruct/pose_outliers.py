"""Cameras that look elsewhere than all others, and how a user leaves them out."""

import shlex
from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float

from industnerf.geometry.cameras import Cameras, common_view_ball

MAX_SHARE = 0.25  # of all cameras; if more look elsewhere, it is not a few poses that are wrong
MIN_OTHERS = 3  # that agree on a point
MAX_PAIRS = 2000  # of axes whose nearest point is tried
MAX_NAMED = 5


def in_frame(cameras: Cameras, point: Float[np.ndarray, "3"]) -> Bool[np.ndarray, "n"]:
    """Which cameras have `point` before them and in their image."""
    return _in_frame(cameras, point[None])[0]


def _in_frame(cameras: Cameras, points: Float[np.ndarray, "m 3"]) -> Bool[np.ndarray, "m n"]:
    to_camera = np.einsum("nji,mnj->mni", cameras.c2w[:, :3, :3], points[:, None] - cameras.centers)
    homogeneous = np.einsum("nij,mnj->mni", cameras.K, to_camera)
    is_before = to_camera[..., 2] > 0
    uv = homogeneous[..., :2] / np.where(is_before, homogeneous[..., 2], 1.0)[..., None]
    return is_before & (uv >= 0).all(axis=2) & (uv <= [cameras.width, cameras.height]).all(axis=2)


def odd_cameras(cameras: Cameras) -> list[int]:
    """Those without which all others have one point in frame; none if that takes too many.

    Of the points to which two axes come nearest, the one that most cameras have in frame tells
    which belong together: a mean of all would be drawn to those that are wrong.
    """
    agreeing = np.arange(len(cameras))
    points = _nearest_points(cameras)
    if len(points):
        visible = _in_frame(cameras, points)
        agreeing = np.flatnonzero(visible[visible.sum(axis=1).argmax()])
    if len(agreeing) < max(MIN_OTHERS, (1 - MAX_SHARE) * len(cameras)):
        return []
    center, _ = common_view_ball(cameras[agreeing])
    is_fine = in_frame(cameras, center)
    return [] if not is_fine[agreeing].all() else np.flatnonzero(~is_fine).tolist()


def _nearest_points(cameras: Cameras) -> Float[np.ndarray, "m 3"]:
    """Where two axes come nearest to each other, for up to MAX_PAIRS pairs, none parallel."""
    first, second = np.triu_indices(len(cameras), 1)
    if len(first) > MAX_PAIRS:
        chosen = np.linspace(0, len(first) - 1, MAX_PAIRS).astype(int)
        first, second = first[chosen], second[chosen]
    axes, centers = cameras.c2w[:, :3, 2], cameras.centers
    baseline = centers[second] - centers[first]
    cosine = np.einsum("ij,ij->i", axes[first], axes[second])
    along_first = np.einsum("ij,ij->i", baseline, axes[first])
    along_second = np.einsum("ij,ij->i", baseline, axes[second])
    sine2 = 1 - cosine**2
    is_usable = sine2 > 1e-6
    t = (along_first - cosine * along_second)[is_usable] / sine2[is_usable]
    s = (cosine * along_first - along_second)[is_usable] / sine2[is_usable]
    on_first = centers[first][is_usable] + t[:, None] * axes[first][is_usable]
    on_second = centers[second][is_usable] + s[:, None] * axes[second][is_usable]
    return (on_first + on_second) / 2


def odd_cameras_error(cameras: Cameras, names: Sequence[str], odd: Sequence[int]) -> str:
    """A sentence that names them, with options to add to the command as they stand."""
    others = np.setdiff1d(np.arange(len(cameras)), odd)
    center, radius = common_view_ball(cameras[others])
    # seven digits of the radius: none of rounding, and no -1e-15
    digits = max(0, 7 - int(np.ceil(np.log10(radius))))
    point = " ".join(f"{round(float(x), digits) + 0.0:g}" for x in center)
    named = ", ".join(str(names[i]) for i in odd[:MAX_NAMED])
    more = ", ..." if len(odd) > MAX_NAMED else ""
    return (
        f"{len(odd)} of {len(cameras)} cameras look elsewhere than all others, that of {named}"
        f"{more}: a wrong pose? Leave out by {exclude_option(names, odd)}; or, if the poses are "
        f"right, state the region of interest by --center {point} --radius {radius:.6g}"
    )


def exclude_option(names: Sequence[str], indices: Sequence[int]) -> str:
    """`--exclude` with the names, as a shell takes them."""
    return " ".join(["--exclude", *(shlex.quote(str(names[i])) for i in indices)])
