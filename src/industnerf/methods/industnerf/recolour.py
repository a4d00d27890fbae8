"""Colours alone, once the surface is found: an addition to the paper, for `industnerf_plus`.

The points of the last level took their colours over from a grid twice as coarse.  Densities stay
as they are, and the surface as soft as at the last step, as pictures show it; space that is empty
for the hard surface is skipped.  What is left is a linear problem, of the same photometric loss,
R10.  The cloud of R11 `surface` is not touched, for the views have had their say on it before.
"""

from collections.abc import Iterator

import torch
from jaxtyping import Float32
from torch import Tensor

from industnerf.methods.industnerf.losses import error
from industnerf.methods.industnerf.optimiser import DECAY
from industnerf.methods.industnerf.training import Training

BETAS = (0.0, 0.99)  # of Adam; no momentum: few of the rays of a step pass a given point


def recolour(training: Training) -> Iterator[Float32[Tensor, ""]]:
    """Take the steps of `training.ways.recolour`; yields the mean squared error at each."""
    ways, field = training.ways.recolour, training.field
    adam = torch.optim.Adam([field.rgb], betas=BETAS, fused=field.rgb.is_cuda)
    for taken in range(ways.steps):
        adam.param_groups[0]["lr"] = ways.rate * DECAY ** (taken / ways.steps)
        values, rgb = field()
        glance = training.glance(values.detach(), rgb)
        loss = error(glance.seen, glance.background, glance.target)
        adam.zero_grad()
        loss.backward()
        adam.step()
        field.settle()
        yield loss.detach()
