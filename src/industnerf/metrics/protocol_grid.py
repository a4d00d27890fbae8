"""The grid of protocols over the clouds of one part, and over its floor."""

from dataclasses import asdict
from pathlib import Path

import numpy as np

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.files import write_json
from industnerf.artifacts.truth import Truth
from industnerf.metrics.emd_grid import LARGE_POINT_COUNT, POINT_COUNTS, emd_grid
from industnerf.metrics.protocol import Evaluator
from industnerf.metrics.truth import sample_reference
from industnerf.schema import EvaluateParams
from industnerf.seeds import generator

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
    """Write `grid.json`: the cells of every cloud, and of a second sample of the truth.

    `many`: with MANY points too.  A cloud of which no point counts has no cell.
    """
    evaluator = Evaluator(part, Truth.load(truth), settings, seed)
    reference = evaluator.reference
    point_counts = (*POINT_COUNTS, LARGE_POINT_COUNT) if include_large else POINT_COUNTS
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
