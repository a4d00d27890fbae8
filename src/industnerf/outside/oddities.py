"""What looks odd about a cloud from outside: another unit, another frame, strays, rounding."""

import numpy as np
from jaxtyping import Float

SIDES = 0.05  # of the diagonal, by which sides of boxes may differ that are the same
ALIKE = (0.5, 2.0)  # ratio of the boxes' diagonals beyond which a unit is wrong, most likely
MIDDLE = 0.99  # of the points, along each axis: what lies far beyond them is stray
STEP = 1e-5  # of the diagonal: a thousandth of what a perfect cloud scores


def oddities(
    points: Float[np.ndarray, "n 3"], truth: Float[np.ndarray, "m 3"], own: bool = False
) -> list[str]:
    """What makes it likely that the unit or the frame is not the part's; both are in mm, float64.

    `own`: the part is of a CAD file of the user's, whose unit may be the wrong one.
    """
    return [*_of_box(points, truth, own), *_of_rounding(points, truth)]


def _of_box(points: np.ndarray, truth: np.ndarray, own: bool) -> list[str]:
    ratio = _size(points) / _size(truth)
    if ALIKE[0] < ratio < ALIKE[1]:
        return _of_place(points, truth)
    core = _without_strays(points)
    if ratio > 1 and ALIKE[0] < _size(core) / _size(truth) < ALIKE[1]:
        strays = (
            f"there are stray points: its box is {ratio:.3g} times as large as the part's, that of "
            f"all but {len(points) - len(core)} of its {len(points)} points "
            f"{_size(core) / _size(truth):.2g} times"
        )
        return [strays, *_of_place(core, truth)]
    unit = ", and the CAD file too (parts.units in params.yaml, if it states none)" if own else ""
    return [f"its box is {ratio:.3g} times as large as the part's: is it in mm{unit}?"]


def _of_place(points: np.ndarray, truth: np.ndarray) -> list[str]:
    sides, wanted = np.ptp(points, axis=0), np.ptp(truth, axis=0)
    middle = points.mean(axis=0, dtype=np.float64)  # sums of float32 go astray
    off = float(np.linalg.norm(middle - truth.mean(axis=0)) / np.linalg.norm(wanted))
    if off > 0.5:
        return [f"its middle is {off:.2g} diagonals from the part's: is it in the cameras' frame?"]
    if _alike(np.sort(sides), np.sort(wanted)) and not _alike(sides, wanted):
        return [
            "its sides are the part's in another order: are its axes those of the cameras' frame?"
        ]
    return []


def _without_strays(points: np.ndarray) -> np.ndarray:
    """The points within the box of the middle 99 % along each axis, grown by half of itself.

    Grown, because the outermost half percent of a face is no stray.
    """
    low, high = np.quantile(points, [(1 - MIDDLE) / 2, (1 + MIDDLE) / 2], axis=0)
    margin = np.linalg.norm(high - low) / 2
    return points[((points >= low - margin) & (points <= high + margin)).all(axis=1)]


def _size(points: np.ndarray) -> float:
    """The diagonal of the bounding box."""
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def _of_rounding(points: np.ndarray, truth: np.ndarray) -> list[str]:
    """Whether float32, in which clouds are kept and scored, rounds the points noticeably."""
    # a cloud in another unit, or with strays, is as exact in its own size
    farthest, diagonal = float(np.abs(points).max()), max(_size(truth), _size(points))
    step = float(np.spacing(np.float32(farthest)))
    if step <= STEP * diagonal:
        return []
    return [
        f"its coordinates reach {farthest:.4g} mm, where float32, in which clouds are scored, has "
        f"steps of {step:.2g} mm, {step / diagonal:.1g} of the diagonal: its points are "
        "rounded to that; move cloud and part to the origin"
    ]


def _alike(a: Float[np.ndarray, "3"], b: Float[np.ndarray, "3"]) -> bool:
    return bool((np.abs(a - b) < SIDES * np.linalg.norm(b)).all())
