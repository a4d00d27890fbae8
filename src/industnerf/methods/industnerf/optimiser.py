"""Adam over what a field learns, some of whose points may leave it on the way."""

import torch
from jaxtyping import Int64
from torch import Tensor

from industnerf.methods.industnerf.field import Field

DECAY = 0.1  # of every learning rate from the first step to the last


class FieldAdam(torch.optim.Adam):
    """The optimiser of one level."""

    def __init__(self, field: Field) -> None:
        groups = field.groups()
        on_gpu = groups[0]["params"][0].is_cuda  # where launching many kernels takes longest
        super().__init__(groups, betas=(0.9, 0.99), eps=1e-8, fused=on_gpu)
        self._field = field
        self._first = [group["lr"] for group in self.param_groups]

    def set_rates(self, share: float, of_distances: float | None) -> None:
        """Where they are after this `share` of all steps; a rate of its own for distances."""
        for group, rate in zip(self.param_groups, self._first, strict=True):
            group["lr"] = rate * DECAY**share
            if of_distances is not None and group["params"][0] is self._field.raw:
                group["lr"] = of_distances

    def keep(self, kept: Int64[Tensor, "k"]) -> None:
        """Leave the field these points alone, in this order, and go on with them as it was."""
        before = self._field.own()
        self._field.keep(kept)
        for old, new in zip(before, self._field.own(), strict=True):
            moments = self.state.pop(old)
            self.state[new] = {
                name: value[kept] if value.shape == old.shape else value
                for name, value in moments.items()
            }
        for group, named in zip(self.param_groups, self._field.groups(), strict=True):
            group["params"] = named["params"]
