"""How fine the first grid is, for `industnerf_plus`: a long part fills little of its ball.

An addition to the paper, whose r is the same for all parts (3.1).
"""

from dataclasses import replace

from industnerf.methods.industnerf.carving import Silhouettes
from industnerf.methods.industnerf.levels import grid, spacing_of
from industnerf.methods.industnerf.relief import MARGIN
from industnerf.schema import IndustnerfSettings

FINEST = 2.0  # times as fine as `grid_res`


def as_fine_as_fits(settings: IndustnerfSettings, silhouettes: Silhouettes) -> IndustnerfSettings:
    """`settings` with a larger `grid_res` if then still no more than `grid_points` may hold matter.

    Of the m points that may at r, there are (r' / r)^3 m at r' if they fill a volume, less if they
    are a skin.  The surface is as soft at first as it would have been: light reaches as deep.
    """
    if not settings.grid_points:
        return settings
    spacing = spacing_of(settings.grid_res, 0)
    points = grid(spacing, silhouettes.device)
    held = int(silhouettes.may_hold(points, margin(settings) * spacing).sum())
    finer = min((settings.grid_points / max(held, 1)) ** (1 / 3), FINEST)
    if finer <= 1:
        return settings
    halves = 2 if settings.warm_up.steps else 1
    grid_res = int(finer * settings.grid_res) // halves * halves
    first = settings.softness.first * grid_res / settings.grid_res
    return replace(settings, grid_res=grid_res, softness=replace(settings.softness, first=first))


def margin(settings: IndustnerfSettings) -> float:
    """How many spacings beyond the hull points are kept."""
    return MARGIN if settings.relief.use else 0.9
