"""What looks odd about a cloud from outside: another unit, another frame, strays, rounding."""

import numpy as np
from jaxtyping import Float

from industnerf.splats import core_box

SIDE_TOLERANCE = 0.05  # of the diagonal, by which sides of boxes may differ that are the same
SIZE_RATIO_RANGE = (
    0.5,
    2.0,
)  # ratio of the boxes' diagonals beyond which a unit is wrong, most likely
MAX_ROUNDING = 1e-5  # of the diagonal: a thousandth of what a perfect cloud scores


def input_warnings(
    points: Float[np.ndarray, "n 3"], truth: Float[np.ndarray, "m 3"], is_user_cad: bool = False
) -> list[str]:
    """What makes it likely that the unit or the frame is not the part's; both are in mm, float64.

    `is_user_cad`: the part is of a CAD file of the user's, whose unit may be the wrong one.
    """
    return [*_box_warnings(points, truth, is_user_cad), *_rounding_warnings(points, truth)]


def _box_warnings(points: np.ndarray, truth: np.ndarray, is_user_cad: bool) -> list[str]:
    ratio = _diagonal(points) / _diagonal(truth)
    if SIZE_RATIO_RANGE[0] < ratio < SIZE_RATIO_RANGE[1]:
        return _placement_warnings(points, truth)
    core = _without_outliers(points)
    if ratio > 1 and SIZE_RATIO_RANGE[0] < _diagonal(core) / _diagonal(truth) < SIZE_RATIO_RANGE[1]:
        stray_warning = (
            f"there are stray points: its box is {ratio:.3g} times as large as the part's, that of "
            f"all but {len(points) - len(core)} of its {len(points)} points "
            f"{_diagonal(core) / _diagonal(truth):.2g} times"
        )
        return [stray_warning, *_placement_warnings(core, truth)]
    unit = (
        ", and the CAD file too (parts.units in params.yaml, if it states none)"
        if is_user_cad
        else ""
    )
    return [f"its box is {ratio:.3g} times as large as the part's: is it in mm{unit}?"]


def _placement_warnings(points: np.ndarray, truth: np.ndarray) -> list[str]:
    sides, truth_sides = np.ptp(points, axis=0), np.ptp(truth, axis=0)
    centroid = points.mean(axis=0, dtype=np.float64)  # sums of float32 go astray
    offset = float(np.linalg.norm(centroid - truth.mean(axis=0)) / np.linalg.norm(truth_sides))
    if offset > 0.5:
        return [
            f"its middle is {offset:.2g} diagonals from the part's: is it in the cameras' frame?"
        ]
    if _is_similar(np.sort(sides), np.sort(truth_sides)) and not _is_similar(sides, truth_sides):
        return [
            "its sides are the part's in another order: are its axes those of the cameras' frame?"
        ]
    return []


def _without_outliers(points: np.ndarray) -> np.ndarray:
    """The points within their core box: the outermost half percent of a face is no stray."""
    low, high = core_box(points)
    return points[((points >= low) & (points <= high)).all(axis=1)]


def _diagonal(points: np.ndarray) -> float:
    """The diagonal of the bounding box."""
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def _rounding_warnings(points: np.ndarray, truth: np.ndarray) -> list[str]:
    """Whether float32, in which clouds are kept and scored, rounds the points noticeably."""
    # a cloud in another unit, or with strays, is as exact in its own size
    max_coordinate, diagonal = float(np.abs(points).max()), max(_diagonal(truth), _diagonal(points))
    step = float(np.spacing(np.float32(max_coordinate)))
    if step <= MAX_ROUNDING * diagonal:
        return []
    return [
        f"its coordinates reach {max_coordinate:.4g} mm, where float32, in which clouds are "
        f"scored, has steps of {step:.2g} mm, {step / diagonal:.1g} of the diagonal: its points "
        "are rounded to that; move cloud and part to the origin"
    ]


def _is_similar(a: Float[np.ndarray, "3"], b: Float[np.ndarray, "3"]) -> bool:
    return bool((np.abs(a - b) < SIDE_TOLERANCE * np.linalg.norm(b)).all())
