"""How fine the first grid is, for `industnerf_plus`: a long part fills little of its ball.

An addition to the paper, whose r is the same for all parts (3.1).
"""

from dataclasses import replace

from industnerf.methods.industnerf.point_levels import grid_spacing, initial_grid
from industnerf.methods.industnerf_plus.sdf_constraints import HULL_MARGIN
from industnerf.methods.industnerf_plus.silhouette_carving import Silhouettes
from industnerf.schema import IndustnerfSettings

MAX_REFINEMENT = 2.0  # times as fine as `grid_res`


def adapt_resolution(settings: IndustnerfSettings, silhouettes: Silhouettes) -> IndustnerfSettings:
    """`settings` with a larger `grid_res` if then still no more than `grid_points` may hold matter.

    Of the m points that may at r, there are (r' / r)^3 m at r' if they fill a volume, less if they
    are a skin.  The surface is as soft at first as it would have been: light reaches as deep.
    """
    if not settings.max_grid_points:
        return settings
    spacing = grid_spacing(settings.grid_res, 0)
    points = initial_grid(spacing, silhouettes.device)
    num_inside = int(silhouettes.inside_hull(points, hull_margin(settings) * spacing).sum())
    refinement = min((settings.max_grid_points / max(num_inside, 1)) ** (1 / 3), MAX_REFINEMENT)
    if refinement <= 1:
        return settings
    divisor = 2 if settings.warm_up.steps else 1
    grid_res = int(refinement * settings.grid_res) // divisor * divisor
    beta_start = settings.beta.start * grid_res / settings.grid_res
    return replace(settings, grid_res=grid_res, beta=replace(settings.beta, start=beta_start))


def hull_margin(settings: IndustnerfSettings) -> float:
    """How many spacings beyond the hull points are kept."""
    return HULL_MARGIN if settings.sdf.enabled else 0.9
