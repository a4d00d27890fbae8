"""Training of the colors alone, once the surface is found.

The points of the last level took their colors over from a grid twice as coarse.  Densities stay,
and the surface is as soft as at the last step; space that is empty for the hard surface is
skipped.  What is left is a linear problem with the photometric loss, R10.  The cloud of R11
`surface_points` does not change: the confidence of its points is computed before.
"""

from collections.abc import Iterator

import torch
from jaxtyping import Float32
from torch import Tensor

from industnerf.methods.industnerf.losses import photometric_loss
from industnerf.methods.industnerf.optimizer import LR_DECAY
from industnerf.methods.industnerf.trainer import Trainer
from industnerf.schema.industnerf import ColorRefinementSettings

BETAS = (0.0, 0.99)  # of Adam; no momentum: few of the rays of a step pass a given point


def refine_colors(
    trainer: Trainer, settings: ColorRefinementSettings
) -> Iterator[Float32[Tensor, ""]]:
    """Take all steps; yields the mean squared error of each."""
    field = trainer.field
    if not settings.steps:
        return
    optimizer = torch.optim.Adam([field.rgb], betas=BETAS, fused=field.rgb.is_cuda)
    for step in range(settings.steps):
        optimizer.param_groups[0]["lr"] = settings.lr * LR_DECAY ** (step / settings.steps)
        values, rgb = field()
        output, batch = trainer.render_batch(values.detach(), rgb)
        loss = photometric_loss(output, batch.background, batch.target)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        field.clamp_parameters()
        yield loss.detach()
