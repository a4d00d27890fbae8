"""Section 3.2, coarse-to-fine sampling: the points of the next level, by eqs. (5)-(9).

They start from the values of the nearest points of the last level.
"""

import numpy as np
import torch
from jaxtyping import Float32, Int64
from pykdtree.kdtree import KDTree
from torch import Tensor

from industnerf.errors import ReconstructionFailed
from industnerf.methods.industnerf.confidence import ViewConfidence
from industnerf.methods.industnerf.density_pdf import effective_cells, sampling_density
from industnerf.methods.industnerf.point_levels import (
    WARM_UP,
    PointLevel,
    grid_mean,
    level_name,
    sample_points,
    subdivide,
    within_radius,
)
from industnerf.methods.industnerf.trainer import Trainer

MIN_SEEN_CONFIDENCE = 0.1  # a point of this confidence counts as seen


def refine_points(
    trainer: Trainer, view_confidence: ViewConfidence, generator: torch.Generator
) -> PointLevel:
    """The points of the next level.

    The grid of the warm-up, and any level where `refine` says so, is subdivided; else points are
    sampled.  Raises ReconstructionFailed if no view has seen any point that has a density.
    """
    settings, old_points = trainer.settings, trainer.points.positions
    sigma = trainer.density()
    if settings.refine == "subdivide" or trainer.level == WARM_UP:
        is_seen = view_confidence.confidence >= MIN_SEEN_CONFIDENCE
        is_near = within_radius(old_points, is_seen, 1.01 * trainer.spacing)
        points = subdivide(old_points[is_near & (sigma > 0)], trainer.spacing)
        spacing = trainer.spacing / 2
    else:
        points, spacing = _sample_new_points(trainer, view_confidence, sigma, generator)
    if not len(points):
        raise ReconstructionFailed(
            f"after {level_name(trainer.level)} no view has a confidence of {MIN_SEEN_CONFIDENCE} "
            "in any point that has a density: are there steps enough, and do the cameras agree on "
            "where the part is?"
        )
    nearest = nearest_indices(old_points, points)
    residuals = None
    if settings.residual.enabled:
        field = trainer.field
        residuals = field.raw.detach()[nearest], field.rgb.detach()[nearest]
    return PointLevel(points, spacing, residuals, view_confidence.per_view[:, nearest])


def _sample_new_points(
    trainer: Trainer,
    view_confidence: ViewConfidence,
    point_density: Float32[Tensor, "m"],
    generator: torch.Generator,
) -> tuple[Float32[Tensor, "n 3"], float]:
    """The old points that have a density and new ones sampled from it, and their spacing.

    The spacing is at most half of the old one, and less where few cells have a density.
    """
    settings, old_points = trainer.settings, trainer.points.positions
    cells = round(2 / trainer.spacing)
    density = sampling_density(
        grid_mean(old_points, point_density, cells),
        grid_mean(old_points, view_confidence.confidence, cells),
        settings.readings.sampling_density,
    )
    count = settings.levels[trainer.level + 1].points
    new_points = sample_points(density, count, generator, settings.readings.sample_position)
    mean_spacing = (effective_cells(density) / count) ** (1 / 3) * 2 / cells
    spacing = min(mean_spacing, trainer.spacing / 2)
    return torch.cat([old_points[point_density > 0], new_points]), spacing


def nearest_indices(
    points: Float32[Tensor, "m 3"], queries: Float32[Tensor, "q 3"]
) -> Int64[Tensor, "q"]:
    """Index of the nearest of `points` to each query."""
    positions, query_positions = (cloud.double().cpu().numpy() for cloud in (points, queries))
    indices = KDTree(positions).query(query_positions)[1].astype(np.int64)
    return torch.from_numpy(indices).to(points.device)
