"""The training part that looks most alike, scaled to the part's size.

A baseline of networks -- Tatarchenko et al., "What Do Single-view 3D
Reconstruction Networks Learn?" (2019), section 3.  Images are compared by histograms of
oriented gradients -- Dalal and Triggs (2005) -- view by view: all parts are photographed by the
same rig, so that the views with the same number look from the same side.

`retrieval_procedural` chooses among procedural solids too.  Of thousands everything is kept in
bytes, and of each surface few but evenly spread points: on dev parts that costs 0.001 of EMD, and
the choice is the same.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float, Float32, Shaped, UInt8

from industnerf.artifacts.state import ModelState
from industnerf.learning.training_shape import NO_PRIOR, Prior, TrainingShape
from industnerf.learning.views import resize_images
from industnerf.methods.base import Example, Input, Method, MethodInputs, Reconstruction, Scope
from industnerf.methods.multi_view_predictions import predictions_to_reconstruction
from industnerf.schema import RetrievalSettings

# of numbers in [0, 1] and in [-1/2, 1/2]
BYTE_STEPS = {np.dtype(np.uint8): 255, np.dtype(np.int8): 254}


def fit(
    examples: Sequence[Example], settings: RetrievalSettings, seed: int, scratch: Path
) -> ModelState:
    """The features of every part's views, and points of its surface."""
    from industnerf.learning.targets import surface_points

    rng = np.random.default_rng(seed)
    view_features = [hog_features(one.rgb(settings.image_px, settings.views)) for one in examples]
    points = [surface_points(*one.mesh, settings.points, rng) for one in examples]
    arrays = {
        "features": np.stack(view_features),
        "points": np.stack(points),
        "views": examples[0].view_indices(settings.views),
    }
    return ModelState(arrays, num_parts=len(examples))


def fit_procedural(
    examples: Sequence[Example],
    settings: RetrievalSettings,
    seed: int,
    scratch: Path,
    prior: Prior = NO_PRIOR,
) -> ModelState:
    """As `fit`, of procedural solids too; of the views those that all shapes have."""
    rng = np.random.default_rng(seed)
    shapes: list[TrainingShape] = [*examples, *prior.solids]
    view_features = [
        to_bytes(hog_features(one.rgb(settings.image_px, settings.views)), np.uint8)
        for one in shapes
    ]
    views = min(map(len, view_features))
    points = [even_points(one.surface_pool(rng), settings.points) for one in shapes]
    arrays = {
        "features": np.stack([one[:views] for one in view_features]),
        "points": to_bytes(np.stack(points), np.int8),
        "views": examples[0].view_indices(views),
    }
    return ModelState(arrays, num_parts=len(examples))


def to_bytes(values: Float[np.ndarray, "*shape"], kind: type) -> Shaped[np.ndarray, "*shape"]:
    """`values` as whole steps of BYTE_STEPS[`kind`], a type of a byte."""
    return np.rint(values * BYTE_STEPS[np.dtype(kind)]).astype(kind)


def from_bytes(values: Shaped[np.ndarray, "*shape"]) -> Float[np.ndarray, "*shape"]:
    """What `to_bytes` was given, to half a step; numbers that are no bytes as they are."""
    steps = BYTE_STEPS.get(values.dtype)
    return values if steps is None else values / np.float32(steps)


def even_points(points: Float[np.ndarray, "pool 3"], count: int) -> Float32[np.ndarray, "n 3"]:
    """At most `count` of `points`, each next one the farthest from all before."""
    import fpsample

    single, count = points.astype(np.float32), min(count, len(points))
    return single[fpsample.bucket_fps_kdline_sampling(single, count, h=7, start_idx=0)]


def hog_features(images: UInt8[np.ndarray, "views px px 3"]) -> Float32[np.ndarray, "views c"]:
    """Histograms of oriented gradients of every image: 9 directions, cells of 8 px."""
    from skimage.feature import hog

    gray = images.mean(axis=3) / 255
    cells = {"pixels_per_cell": (8, 8), "cells_per_block": (2, 2)}
    return np.stack([hog(one, orientations=9, **cells) for one in gray]).astype(np.float32)


def reconstruct(
    inputs: MethodInputs, settings: RetrievalSettings, state: ModelState, seed: int
) -> Reconstruction:
    """The surface of the part whose views are nearest, summed over the views that both have.

    Both have the first: every nested order begins with it.
    """
    given, stored = inputs.view_indices, state.arrays["views"]
    given = np.arange(len(inputs.rgb)) if given is None else given
    _, input_views, stored_views = np.intersect1d(given, stored, return_indices=True)
    query_features = hog_features(resize_images(inputs.rgb[input_views], settings.image_px))
    distances = feature_distances(state.arrays["features"][:, stored_views], query_features)
    points = from_bytes(state.arrays["points"][int(np.argmin(distances))])
    return predictions_to_reconstruction([points.astype(np.float64)], inputs.part_frame, state)


def feature_distances(
    part_features: Float32[np.ndarray, "parts views c"] | UInt8[np.ndarray, "parts views c"],
    query_features: Float32[np.ndarray, "views c"],
) -> Float[np.ndarray, "parts"]:
    """Of every part the sum over the views of the distance between features."""
    return sum(
        np.linalg.norm(from_bytes(part_features[:, view]) - query, axis=1)
        for view, query in enumerate(query_features)
    )


INPUTS = frozenset({Input.RGB, Input.PART_FRAME, Input.OTHER_MESHES})
METHODS = {
    "retrieval": Method("retrieval", Scope.DATASET, INPUTS, reconstruct, fit),
    "retrieval_procedural": Method(
        "retrieval_procedural",
        Scope.DATASET,
        INPUTS | {Input.PROCEDURAL_SOLIDS},
        reconstruct,
        fit_procedural,
    ),
}
