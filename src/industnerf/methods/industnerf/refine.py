"""The points of the next level, section 3.2, and what they take over from the last."""

import numpy as np
import torch
from jaxtyping import Float32, Int64
from pykdtree.kdtree import KDTree
from torch import Tensor

from industnerf.errors import ReconstructionFailed
from industnerf.methods.industnerf.beside import finer_surface
from industnerf.methods.industnerf.distribution import density_to_sample, effective_cells
from industnerf.methods.industnerf.levels import (
    WARM_UP,
    Layer,
    divided,
    name_of,
    near_any,
    on_grid,
    sampled,
)
from industnerf.methods.industnerf.training import Training
from industnerf.methods.industnerf.witnesses import Testimony

SEEN = 0.1  # confidence from which on a point counts as seen


def refined(training: Training, told: Testimony | None, generator: torch.Generator) -> Layer:
    """The points that follow on those of `training`, of which the views said what was `told`.

    The warm-up's are divided into the first grid; so are all others where `refine` says so.  Of
    a relief those beside its surface are.  Raises ReconstructionFailed if no view is
    sure of any, of which a relief asks nothing.
    """
    ways, old = training.ways, training.points.positions
    field = training.field
    if training.relief:
        return finer_surface(old, field.raw.detach(), field.rgb.detach(), training.spacing)
    sigma = training.density()
    spacing = training.spacing / 2
    if ways.refine == "divided" or training.level == WARM_UP:
        near = near_any(old, told.confidence >= SEEN, 1.01 * training.spacing)
        points = divided(old[near & (sigma > 0)], training.spacing)
    else:
        points, spacing = _drawn(training, told, sigma, generator)
    if not len(points):
        raise ReconstructionFailed(
            f"after {name_of(training.level)} no view is surer than {SEEN} of a point that has a "
            "density: are there steps enough, and do the cameras agree on where the part is?"
        )
    which = nearest(old, points)
    return Layer(
        points,
        spacing,
        (field.raw.detach()[which], field.rgb.detach()[which]) if ways.residual.use else None,
        told.of_views[:, which],
    )


def _drawn(
    training: Training,
    told: Testimony,
    sigma: Float32[Tensor, "m"],
    generator: torch.Generator,
) -> tuple[Float32[Tensor, "n 3"], float]:
    """The old points that have a density, and new ones drawn by it; and their spacing.

    That is at most the half of the old: where matter is thin, its points come closer.
    """
    ways, old = training.ways, training.points.positions
    cells = round(2 / training.spacing)
    density = density_to_sample(
        on_grid(old, sigma, cells), on_grid(old, told.confidence, cells), ways.readings.target
    )
    count = ways.levels[training.level + 1].points
    fresh = sampled(density, count, generator, ways.readings.place)
    apart = (effective_cells(density) / count) ** (1 / 3) * 2 / cells
    return torch.cat([old[sigma > 0], fresh]), min(apart, training.spacing / 2)


def nearest(points: Float32[Tensor, "m 3"], queries: Float32[Tensor, "q 3"]) -> Int64[Tensor, "q"]:
    """Which of `points` is nearest to every query."""
    known, asked = (places.double().cpu().numpy() for places in (points, queries))
    found = KDTree(known).query(asked)[1].astype(np.int64)
    return torch.from_numpy(found).to(points.device)
