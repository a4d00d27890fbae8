"""Cameras that look elsewhere than all others, and how a user leaves them out."""

import shlex
from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float

from industnerf.geometry.cameras import Cameras, common_view_ball, project

MAX_SHARE = 0.25  # of all cameras; if more look elsewhere, it is not a few poses that are wrong
MIN_OTHERS = 3  # that agree on a point
MAX_NAMED = 5


def in_frame(cameras: Cameras, point: Float[np.ndarray, "3"]) -> Bool[np.ndarray, "n"]:
    """Which cameras have `point` before them and in their image."""
    visible = np.zeros(len(cameras), bool)
    for i, (K, c2w) in enumerate(zip(cameras.K, cameras.c2w, strict=True)):
        if (point - c2w[:3, 3]) @ c2w[:3, 2] > 0:
            u, v = project(point[None], K, c2w)[0][0]
            visible[i] = 0 <= u <= cameras.width and 0 <= v <= cameras.height
    return visible


def odd_cameras(cameras: Cameras) -> list[int]:
    """Those without which all others have one point in frame; none if that takes too many.

    The one that looks farthest from the point nearest to all axes goes first, until all agree.
    """
    kept = np.arange(len(cameras))
    while len(kept) >= MIN_OTHERS and len(cameras) - len(kept) <= MAX_SHARE * len(cameras):
        others = cameras[kept]
        center, _ = common_view_ball(others)
        if in_frame(others, center).all():
            return sorted(set(range(len(cameras))) - set(kept.tolist()))
        direction = center - others.centers
        cosine = np.einsum("ij,ij->i", direction, others.c2w[:, :3, 2])
        cosine /= np.maximum(np.linalg.norm(direction, axis=1), 1e-300)
        kept = np.delete(kept, int(np.argmin(cosine)))
    return []


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
