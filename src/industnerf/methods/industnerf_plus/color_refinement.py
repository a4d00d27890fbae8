"""Colors alone, once the surface is found: an addition to the paper, for `industnerf_plus`.

The points of the last level took their colors over from a grid twice as coarse.  Densities stay
as they are, and the surface as soft as at the last step, as pictures show it; space that is empty
for the hard surface is skipped.  What is left is a linear problem, of the same photometric loss,
R10.  The cloud of R11 `surface` is not touched, for the views have had their say on it before.
"""

from collections.abc import Iterator

import torch
from jaxtyping import Float32
from torch import Tensor

from industnerf.methods.industnerf.losses import photometric_loss
from industnerf.methods.industnerf.optimizer import LR_DECAY
from industnerf.methods.industnerf.trainer import Trainer

BETAS = (0.0, 0.99)  # of Adam; no momentum: few of the rays of a step pass a given point


def refine_colors(trainer: Trainer) -> Iterator[Float32[Tensor, ""]]:
    """Take the steps of `training.ways.recolor`; yields the mean squared error at each."""
    refinement_settings, field = trainer.settings.color_refinement, trainer.field
    optimizer = torch.optim.Adam([field.rgb], betas=BETAS, fused=field.rgb.is_cuda)
    for step in range(refinement_settings.steps):
        optimizer.param_groups[0]["lr"] = refinement_settings.lr * LR_DECAY ** (
            step / refinement_settings.steps
        )
        values, rgb = field()
        batch = trainer.render_batch(values.detach(), rgb)
        loss = photometric_loss(batch.output, batch.background, batch.target)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        field.clamp_parameters()
        yield loss.detach()
