"""Where a variant of the method may differ from section 3: each hook does what the paper does.

`industnerf_plus` subclasses it.  The variants that only have other settings or inputs do not need
to: `industnerf_depth`, `industnerf_shared` and `nerf`.
"""

import torch

from industnerf.methods.industnerf.confidence import ViewConfidence
from industnerf.methods.industnerf.optimizer import Constraints
from industnerf.methods.industnerf.point_levels import PointLevel
from industnerf.methods.industnerf.refine import refine_points
from industnerf.methods.industnerf.scene import NerfScene, PosedImages
from industnerf.methods.industnerf.trainer import Trainer
from industnerf.rendering.points import PointGrid
from industnerf.schema import IndustnerfSettings


class Variant:
    """The paper's method, asked once for every run and level."""

    def __init__(self, scene: NerfScene, posed: PosedImages, settings: IndustnerfSettings) -> None:
        self.settings = settings  # of the run; a variant may fit them to the images
        self.warnings: tuple[str, ...] = ()  # about the images, for their owner

    def initial_points(self, points: PointLevel) -> PointLevel:
        """Those of the points of a level that it starts with."""
        return points

    def constraints(self, points: PointLevel, grid: PointGrid) -> Constraints:
        """What holds the values of the points during training; `grid` has them sorted."""
        return Constraints()

    def refine(
        self, trainer: Trainer, confidence: ViewConfidence | None, generator: torch.Generator
    ) -> PointLevel:
        """Section 3.2: the points of the next level."""
        return refine_points(trainer, confidence, generator)
