"""The points of the next level, section 3.2, and what they take over from the last."""

import torch
from jaxtyping import Float32, Int64
from scipy.spatial import cKDTree
from torch import Tensor

from industnerf.methods.industnerf.levels import divided, near_any, sampled
from industnerf.methods.industnerf.training import Training
from industnerf.methods.industnerf.witnesses import Testimony


def refined(
    training: Training, told: Testimony, generator: torch.Generator
) -> tuple[Float32[Tensor, "n 3"], tuple[Tensor, Tensor] | None]:
    """The next level's points, and where their residuals start: at those of the nearest point."""
    ways, level, old = training.ways, training.level, training.points.positions
    sigma = training.density()
    if ways.refine == "divided":
        near = near_any(old, told.confidence >= ways.least_confidence, 1.01 * training.spacing)
        points = divided(old[near & (sigma > 0)], training.spacing)
    else:
        cells = ways.grid_res * 2**level
        count = ways.levels[level + 1].points
        readings = ways.readings
        fresh = sampled(
            old, sigma, told.confidence, cells, count, generator, readings.target, readings.place
        )
        points = torch.cat([old[sigma > 0], fresh])
    if not ways.residual.use:
        return points, None
    which = nearest(old, points)
    return points, (training.field.raw.detach()[which], training.field.rgb.detach()[which])


def nearest(points: Float32[Tensor, "m 3"], queries: Float32[Tensor, "q 3"]) -> Int64[Tensor, "q"]:
    """Which of `points` is nearest to every query."""
    found = cKDTree(points.cpu().numpy()).query(queries.cpu().numpy())[1]
    return torch.from_numpy(found).to(points.device)
