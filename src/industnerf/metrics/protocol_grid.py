"""A part's clouds under every protocol that the paper's section 4.3 may mean: R13.

The paper prints an EMD and says neither how many points are compared, nor how they are chosen, in
which unit, by which ground cost, nor whether the inside of a part counts.
"""

from dataclasses import asdict, dataclass
from itertools import product
from pathlib import Path

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.files import write_json
from industnerf.artifacts.truth import Truth
from industnerf.metrics.emd import emd
from industnerf.metrics.protocol import Evaluator
from industnerf.metrics.subsample import farthest_points, random_points
from industnerf.metrics.surface_samples import SampledSurface, sample_reference
from industnerf.schema import EvaluateParams
from industnerf.seeds import generator

POINT_COUNTS = (1024, 2048, 4096)  # on either side
LARGE_POINT_COUNTS = (8192, 16384)  # of a few parts: each takes seconds
REDUCTIONS, SURFACES = ("even", "iid"), ("visible", "full")


@dataclass(frozen=True)
class GridCell:
    """An EMD under one protocol; `scale` is the length of the true box that is 1."""

    points: int
    reduction: str  # even, iid: of the prediction; the truth is always even
    surface: str  # visible, full
    cost: str  # distance, squared
    scale: str  # diagonal, longest: edge
    value: float


def emd_grid(
    truth: SampledSurface,
    predicted: SampledSurface,
    diagonal_in_edges: float,
    point_counts: tuple[int, ...],
    rng: np.random.Generator,
) -> list[GridCell]:
    """The cells of a cloud; `diagonal_in_edges` is the diagonal in longest edges.

    A cell is left out if either side has fewer points than it asks for.
    """
    cells = []
    for surface, count in product(SURFACES, point_counts):
        truth_points, predicted_points = (_points_on(side, surface) for side in (truth, predicted))
        if min(len(truth_points), len(predicted_points)) < count:
            continue
        truth_subset = farthest_points(truth_points, count)
        for reduction in REDUCTIONS:
            predicted_subset = (
                farthest_points(predicted_points, count)
                if reduction == "even"
                else random_points(predicted_points, count, rng)
            )
            protocol = (count, reduction, surface)
            cells += _in_both_units(
                protocol, "distance", emd(truth_subset, predicted_subset).value, diagonal_in_edges
            )
            cells += _in_both_units(
                protocol,
                "squared",
                emd(truth_subset, predicted_subset, squared=True).value,
                diagonal_in_edges**2,
            )
    return cells


def _points_on(side: SampledSurface, surface: str) -> Float[np.ndarray, "n 3"]:
    return side.points if surface == "full" else side.visible_points


def _in_both_units(protocol: tuple, cost: str, value: float, factor: float) -> list[GridCell]:
    """In diagonals and in longest edges: a change of unit needs no second solution."""
    return [
        GridCell(*protocol, cost, "diagonal", value),
        GridCell(*protocol, cost, "longest", value * factor),
    ]


SCHEMA = 1
FLOOR = "floor"


def measure_grid(
    part: Path,
    truth: Path,
    clouds: dict[str, Path],
    target: Path,
    *,
    settings: EvaluateParams,
    seed: int,
    include_large: bool,
) -> None:
    """Write `grid.json`: the cells of every cloud, and of one second sample of the truth.

    `include_large`: with LARGE_POINT_COUNTS points too.  A cloud of which no point counts has none.
    """
    evaluator = Evaluator(part, Truth.load(truth), settings, seed)
    reference = evaluator.reference
    point_counts = (*POINT_COUNTS, *LARGE_POINT_COUNTS) if include_large else POINT_COUNTS
    diagonal_in_edges = reference.diagonal_mm / float(np.ptp(reference.mesh.vertices, axis=0).max())
    rngs = {name: generator(seed, "grid", part.name, name) for name in [FLOOR, *clouds]}
    surfaces = {FLOOR: sample_reference(part.name, reference, settings, seed, "floor")[1]}
    surfaces |= {
        name: evaluator.sample_prediction(Cloud.load(folder).points_mm, rngs[name])
        for name, folder in clouds.items()
    }
    cells = {
        name: [
            asdict(cell)
            for cell in emd_grid(
                evaluator.truth, surface, diagonal_in_edges, point_counts, rngs[name]
            )
        ]
        for name, surface in surfaces.items()
        if surface is not None
    }
    write_json(target / "grid.json", {"schema": SCHEMA, "cells": cells})
