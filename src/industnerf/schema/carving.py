"""When photographs contradict each other: space carving, by itself and as a start."""

from dataclasses import dataclass
from typing import Annotated

from industnerf.schema.rules import CountOr0, Rule, Share, at_least, within

BLOCKS = Rule(lambda n: 32 <= n <= 512 and n % 8 == 0, "a multiple of 8 in [32, 512]")


@dataclass(frozen=True)
class SpaceCarvingSettings:
    """The lattice, and what a cell must show to its views in order to stay."""

    grid_res: Annotated[int, BLOCKS]
    threshold: Share
    footprint: Annotated[float, within("(0, 8]", " cells")]
    facing: Annotated[float, within("[-1, 1)")]
    outliers: Annotated[float, within("[0, 0.5)")]
    views: Annotated[int, at_least(2)]
    sweeps: CountOr0
    least_filled: Share
