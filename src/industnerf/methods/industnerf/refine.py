"""The points of the next level, section 3.2, and what they take over from the last."""

import numpy as np
import torch
from jaxtyping import Float32, Int64
from pykdtree.kdtree import KDTree
from torch import Tensor

from industnerf.errors import ReconstructionFailed
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
from industnerf.methods.industnerf.view_confidence import ViewConfidence
from industnerf.methods.industnerf_plus.narrow_band import subdivide_narrow_band

MIN_SEEN_CONFIDENCE = 0.1  # confidence from which on a point counts as seen


def refine_points(
    trainer: Trainer, view_confidence: ViewConfidence | None, generator: torch.Generator
) -> PointLevel:
    """The points that follow on those of `training`, of which the views said what was `told`.

    The warm-up's are divided into the first grid; so are all others where `refine` says so.  Of
    a relief those beside its surface are.  Raises ReconstructionFailed if no view is
    sure of any, of which a relief asks nothing.
    """
    settings, old_points = trainer.settings, trainer.points.positions
    field = trainer.field
    if trainer.sdf_constraints:
        return subdivide_narrow_band(
            old_points, field.raw.detach(), field.rgb.detach(), trainer.spacing
        )
    sigma = trainer.density()
    spacing = trainer.spacing / 2
    if settings.refine == "subdivide" or trainer.level == WARM_UP:
        is_near = within_radius(
            old_points, view_confidence.confidence >= MIN_SEEN_CONFIDENCE, 1.01 * trainer.spacing
        )
        points = subdivide(old_points[is_near & (sigma > 0)], trainer.spacing)
    else:
        points, spacing = _sample_new_points(trainer, view_confidence, sigma, generator)
    if not len(points):
        raise ReconstructionFailed(
            f"after {level_name(trainer.level)} no view is surer than {MIN_SEEN_CONFIDENCE} of a point that has a "
            "density: are there steps enough, and do the cameras agree on where the part is?"
        )
    source_indices = nearest_indices(old_points, points)
    return PointLevel(
        points,
        spacing,
        (field.raw.detach()[source_indices], field.rgb.detach()[source_indices])
        if settings.residual.enabled
        else None,
        view_confidence.per_view[:, source_indices],
    )


def _sample_new_points(
    trainer: Trainer,
    view_confidence: ViewConfidence,
    point_density: Float32[Tensor, "m"],
    generator: torch.Generator,
) -> tuple[Float32[Tensor, "n 3"], float]:
    """The old points that have a density, and new ones drawn by it; and their spacing.

    That is at most the half of the old: where matter is thin, its points come closer.
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
    return torch.cat([old_points[point_density > 0], new_points]), min(
        mean_spacing, trainer.spacing / 2
    )


def nearest_indices(
    points: Float32[Tensor, "m 3"], queries: Float32[Tensor, "q 3"]
) -> Int64[Tensor, "q"]:
    """Which of `points` is nearest to every query."""
    positions, query_positions = (cloud.double().cpu().numpy() for cloud in (points, queries))
    indices = KDTree(positions).query(query_positions)[1].astype(np.int64)
    return torch.from_numpy(indices).to(points.device)
