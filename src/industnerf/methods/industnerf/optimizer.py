"""Adam over what a field learns, some of whose points may leave it on the way."""

import torch
from jaxtyping import Int64
from torch import Tensor

from industnerf.methods.industnerf.field import Field

LR_DECAY = 0.1  # of every learning rate from the first step to the last


class FieldAdam(torch.optim.Adam):
    """The optimizer of one level."""

    def __init__(self, field: Field) -> None:
        param_groups = field.param_groups()
        on_gpu = param_groups[0]["params"][0].is_cuda  # where launching many kernels takes longest
        super().__init__(param_groups, betas=(0.9, 0.99), eps=1e-8, fused=on_gpu)
        self._field = field
        self._initial_lrs = [group["lr"] for group in self.param_groups]

    def set_lrs(self, progress: float, sdf_lr: float | None) -> None:
        """Where they are after this `share` of all steps; a rate of its own for distances."""
        for group, initial_lr in zip(self.param_groups, self._initial_lrs, strict=True):
            group["lr"] = initial_lr * LR_DECAY**progress
            if sdf_lr is not None and group["params"][0] is self._field.raw:
                group["lr"] = sdf_lr

    def select_points(self, indices: Int64[Tensor, "k"]) -> None:
        """Leave the field these points alone, in this order, and go on with them as it was."""
        old_parameters = self._field.point_parameters()
        self._field.select_points(indices)
        for old, new in zip(old_parameters, self._field.point_parameters(), strict=True):
            optimizer_state = self.state.pop(old)
            self.state[new] = {
                name: value[indices] if value.shape == old.shape else value
                for name, value in optimizer_state.items()
            }
        for group, field_group in zip(self.param_groups, self._field.param_groups(), strict=True):
            group["params"] = field_group["params"]
