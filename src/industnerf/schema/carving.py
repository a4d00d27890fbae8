"""When photographs contradict each other: space carving, by itself and as a start."""

from dataclasses import dataclass
from typing import Annotated

from industnerf.schema.validators import Fraction, NonNegativeInt, Rule, at_least, in_interval

CARVING_GRID_RES = Rule(lambda n: 32 <= n <= 512 and n % 8 == 0, "a multiple of 8 in [32, 512]")


@dataclass(frozen=True)
class SpaceCarvingSettings:
    """The lattice, and what a cell must show to its views in order to stay."""

    grid_res: Annotated[int, CARVING_GRID_RES]
    color_threshold: Fraction
    voxel_footprint: Annotated[float, in_interval("(0, 8]", " cells")]
    min_view_cosine: Annotated[float, in_interval("[-1, 1)")]
    outlier_fraction: Annotated[float, in_interval("[0, 0.5)")]
    min_views: Annotated[int, at_least(2)]
    max_sweeps: NonNegativeInt
    min_silhouette_coverage: Fraction
