"""Checks of what a method returned."""

import numpy as np

from industnerf.artifacts.renderings import Renderings
from industnerf.errors import ReconstructionFailed
from industnerf.geometry.cameras import Cameras
from industnerf.methods.base import MethodInputs, Reconstruction


def check_reconstruction(result: Reconstruction, inputs: MethodInputs) -> Reconstruction:
    """`result`, or ReconstructionFailed if it is empty, not finite or of views that are none."""
    if not len(result.points_mm):
        raise ReconstructionFailed("empty: the method returned no point")
    _refuse_not_finite(result.points_mm, "points")
    for points in result.extra_clouds_mm:
        _refuse_not_finite(points, "points of a further prediction")
    if result.confidence is not None:
        _refuse_not_finite(result.confidence, "values of confidence")
    if result.view is not None:
        _refuse_unknown_views(result.view, len(inputs.cameras))
    if result.candidates is not None:
        _refuse_not_finite(result.candidates.points_mm, "candidates")
        _refuse_not_finite(result.candidates.confidence, "values of the candidates' confidence")
    return result


def check_renderings(renderings: Renderings, inputs: MethodInputs) -> Renderings:
    """`renderings`, or ReconstructionFailed if they are of other views or have no depth."""
    _refuse_other_cameras(renderings, inputs.held_out)
    _refuse_not_finite(renderings.depth_mm, "rendered rows of depth")
    if (renderings.depth_mm < 0).any():
        raise ReconstructionFailed("the renderings show something behind the camera")
    return renderings


def _refuse_not_finite(values: np.ndarray, name: str) -> None:
    rows = np.isfinite(values).reshape(-1, values.shape[-1] if values.ndim > 1 else 1)
    bad = int((~rows.all(axis=1)).sum())
    if bad:
        raise ReconstructionFailed(f"not finite: {bad} of {len(rows)} {name}")


def _refuse_unknown_views(view: np.ndarray, count: int) -> None:
    is_invalid = (view < -1) | (view >= count)
    if is_invalid.any():
        raise ReconstructionFailed(
            f"{is_invalid.sum()} of {len(view)} points name a training view that is none, such as "
            f"{view[is_invalid][0]} of {count}"
        )


def _refuse_other_cameras(renderings: Renderings, expected: Cameras) -> None:
    expected_shape = (len(expected), expected.height, expected.width)
    if renderings.opacity.shape != expected_shape:
        raise ReconstructionFailed(
            f"the renderings have shape {renderings.opacity.shape}, "
            f"the held-out cameras {expected_shape}"
        )
