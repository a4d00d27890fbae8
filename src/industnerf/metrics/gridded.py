"""The grid of protocols over the clouds of one part, and over its floor."""

from dataclasses import asdict
from pathlib import Path

import numpy as np

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.files import write_json
from industnerf.artifacts.truth import Truth
from industnerf.metrics.grid import MANY, POINTS, grid
from industnerf.metrics.protocol import Judge
from industnerf.metrics.truth import surface_sample
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
    many: bool,
) -> None:
    """Write `grid.json`: the cells of every cloud, and of a second sample of the truth.

    `many`: with MANY points too.  A cloud of which no point counts has no cell.
    """
    judge = Judge(part, Truth.load(truth), settings, seed)
    frame, points = judge.frame, (*POINTS, MANY) if many else POINTS
    diagonals = frame.diagonal_mm / float(np.ptp(frame.mesh.vertices, axis=0).max())
    rngs = {name: generator(seed, "grid", part.name, name) for name in [FLOOR, *clouds]}
    shown = {FLOOR: surface_sample(part.name, frame, settings, seed, "floor")[1]}
    shown |= {
        name: judge.sampled(Cloud.load(at).points_mm, rngs[name]) for name, at in clouds.items()
    }
    cells = {
        name: [asdict(cell) for cell in grid(judge.truth, side, diagonals, points, rngs[name])]
        for name, side in shown.items()
        if side is not None
    }
    write_json(target / "grid.json", {"schema": SCHEMA, "cells": cells})
