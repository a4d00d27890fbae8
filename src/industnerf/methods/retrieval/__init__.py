"""The training part that looks most alike, scaled to the part's size.

A baseline of networks -- Tatarchenko et al., "What Do Single-view 3D
Reconstruction Networks Learn?" (2019), section 3.  Images are compared by histograms of
oriented gradients -- Dalal and Triggs (2005) -- view by view: all parts are photographed by the
same rig, so that the views with the same number look from the same side.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float, Float32, UInt8

from industnerf.artifacts.state import ModelState
from industnerf.learning.views import resize_images
from industnerf.methods.base import Example, Input, Method, MethodInputs, Reconstruction, Scope
from industnerf.methods.multi_view_predictions import predictions_to_reconstruction
from industnerf.schema import RetrievalSettings


def fit(
    examples: Sequence[Example], settings: RetrievalSettings, seed: int, scratch: Path
) -> ModelState:
    """The features of every part's views, and points of its surface."""
    from industnerf.learning.targets import surface_points

    rng = np.random.default_rng(seed)
    view_features = [features(one.rgb(settings.image_px, settings.views)) for one in examples]
    points = [surface_points(*one.mesh, settings.points, rng) for one in examples]
    arrays = {
        "features": np.stack(view_features),
        "points": np.stack(points),
        "views": examples[0].view_indices(settings.views),
    }
    return ModelState(arrays, num_parts=len(examples))


def features(images: UInt8[np.ndarray, "views px px 3"]) -> Float32[np.ndarray, "views c"]:
    """Histograms of oriented gradients of every image: 9 directions, cells of 8 px."""
    from skimage.feature import hog

    gray = images.mean(axis=3) / 255
    cells = {"pixels_per_cell": (8, 8), "cells_per_block": (2, 2)}
    return np.stack([hog(one, orientations=9, **cells) for one in gray]).astype(np.float32)


def reconstruct(
    inputs: MethodInputs, settings: RetrievalSettings, state: ModelState, seed: int
) -> Reconstruction:
    """The surface of the part whose views are nearest, summed over the views that both have.

    Both have the first: `nested_view_subset` and `evenly_spaced_indices` begin with it.
    """
    given, stored = inputs.view_indices, state.arrays["views"]
    given = np.arange(len(inputs.rgb)) if given is None else given
    _, input_views, stored_views = np.intersect1d(given, stored, return_indices=True)
    query_features = features(resize_images(inputs.rgb[input_views], settings.image_px))
    nearest = int(np.argmin(distances(state.arrays["features"][:, stored_views], query_features)))
    return predictions_to_reconstruction(
        [state.arrays["points"][nearest].astype(np.float64)], inputs.part_frame, state
    )


def distances(
    part_features: Float32[np.ndarray, "parts views c"],
    query_features: Float32[np.ndarray, "views c"],
) -> Float[np.ndarray, "parts"]:
    """Of every part the sum over the views of the distance between features."""
    return np.linalg.norm(part_features - query_features, axis=2).sum(axis=1)


METHODS = {
    "retrieval": Method(
        "retrieval",
        Scope.DATASET,
        frozenset({Input.RGB, Input.PART_FRAME, Input.OTHER_MESHES}),
        reconstruct,
        fit,
    )
}
