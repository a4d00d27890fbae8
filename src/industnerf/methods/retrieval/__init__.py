"""The part learned from that looks most alike, scaled to the part's size.

What a net must beat to deserve its name -- Tatarchenko et al., "What Do Single-view 3D
Reconstruction Networks Learn?" (2019), section 3.  Pictures are compared by histograms of
oriented gradients -- Dalal and Triggs (2005) -- view by view: all parts are photographed by the
same rig, so that the views with the same number look from the same side.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float, Float32, UInt8

from industnerf.artifacts.state import State
from industnerf.learning.pictures import scaled
from industnerf.methods.answers import answered
from industnerf.methods.base import Example, Given, Input, Method, Reconstruction, Scope
from industnerf.schema import RetrievalSettings


def fit(
    examples: Sequence[Example], settings: RetrievalSettings, seed: int, scratch: Path
) -> State:
    """The features of every part's views, and points of its surface."""
    from industnerf.learning.targets import surface_points

    rng = np.random.default_rng(seed)
    looks = [features(one.rgb(settings.image_px, settings.views)) for one in examples]
    points = [surface_points(*one.mesh, settings.points, rng) for one in examples]
    known = {
        "features": np.stack(looks),
        "points": np.stack(points),
        "views": examples[0].numbers(settings.views),
    }
    return State(known, parts=len(examples))


def features(images: UInt8[np.ndarray, "views px px 3"]) -> Float32[np.ndarray, "views c"]:
    """Histograms of oriented gradients of every image: 9 directions, cells of 8 px."""
    from skimage.feature import hog

    grey = images.mean(axis=3) / 255
    cells = {"pixels_per_cell": (8, 8), "cells_per_block": (2, 2)}
    return np.stack([hog(one, orientations=9, **cells) for one in grey]).astype(np.float32)


def reconstruct(
    given: Given, settings: RetrievalSettings, state: State, seed: int
) -> Reconstruction:
    """The surface of the part whose views are nearest, summed over the views that both have.

    Both have the first: `nested` and `evenly` begin with it.
    """
    given_views = np.arange(len(given.rgb)) if given.chosen is None else given.chosen
    _, mine, theirs = np.intersect1d(given_views, state.arrays["views"], return_indices=True)
    looks = features(scaled(given.rgb[mine], settings.image_px))
    nearest = int(np.argmin(distances(state.arrays["features"][:, theirs], looks)))
    return answered([state.arrays["points"][nearest].astype(np.float64)], given.frame, state)


def distances(
    theirs: Float32[np.ndarray, "parts views c"], mine: Float32[np.ndarray, "views c"]
) -> Float[np.ndarray, "parts"]:
    """Of every part the sum over the views of the distance between features."""
    return np.linalg.norm(theirs - mine, axis=2).sum(axis=1)


METHODS = {
    "retrieval": Method(
        "retrieval",
        Scope.DATASET,
        frozenset({Input.RGB, Input.FRAME, Input.OTHER_MESHES}),
        reconstruct,
        fit,
    )
}
