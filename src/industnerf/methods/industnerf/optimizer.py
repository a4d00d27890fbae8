"""Section 3.3, training: Adam, and the schedules of its learning rates and of the softness.

The paper does not say how the field is trained.  Both schedules fall geometrically from the first
step of the warm-up to the last step of the last level.
"""

import torch
from jaxtyping import Float32, Int64
from torch import Tensor

from industnerf.methods.industnerf.field import Field
from industnerf.schema import IndustnerfSettings

LR_DECAY = 0.1  # of every learning rate, from the first step to the last


def training_progress(settings: IndustnerfSettings, level: int, steps_done: int) -> float:
    """Share of the steps of all levels that is done after `steps_done` steps of `level`."""
    levels = [settings.warm_up, *settings.levels]
    previous_steps = sum(each.steps for each in levels[: level + 1])
    return (previous_steps + steps_done) / sum(each.steps for each in levels)


def beta_at(settings: IndustnerfSettings, progress: float) -> float:
    """Softness of the surface, in spacings of the first level."""
    return settings.beta.start * (settings.beta.end / settings.beta.start) ** progress


class FieldAdam(torch.optim.Adam):
    """The optimizer of one level."""

    def __init__(self, field: Field) -> None:
        param_groups = field.param_groups()
        on_gpu = param_groups[0]["params"][0].is_cuda  # where launching many kernels takes longest
        super().__init__(param_groups, betas=(0.9, 0.99), eps=1e-8, fused=on_gpu)
        self._field = field
        self._initial_lrs = [group["lr"] for group in self.param_groups]

    def set_lrs(self, progress: float, raw_lr: float | None) -> None:
        """Learning rates at this share of all steps; `raw_lr`, if any, is that of `field.raw`."""
        for group, initial_lr in zip(self.param_groups, self._initial_lrs, strict=True):
            group["lr"] = initial_lr * LR_DECAY**progress
            if raw_lr is not None and group["params"][0] is self._field.raw:
                group["lr"] = raw_lr

    def select_points(self, indices: Int64[Tensor, "k"]) -> None:
        """Keep only these points of the field, in this order, with their moments."""
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


class Constraints:
    """What holds the raw values of the points during training: in the paper, nothing.

    A variant of the method subclasses it.
    """

    def visible_points(
        self, points: Float32[Tensor, "m 3"], order: Int64[Tensor, "m"]
    ) -> Float32[Tensor, "v 3"]:
        """The points whose pixels are trained on; the constraints have them in `order`."""
        return points

    def initial_raw(self, raw: Float32[Tensor, "m"] | None) -> Float32[Tensor, "m"] | None:
        """Raw values to start from, given those of the last level."""
        return raw

    def lr(self, beta: float) -> float | None:
        """Learning rate of the raw values at softness `beta`; None: as scheduled."""
        return None

    def project(self, field: Field, beta: float, steps_done: int, num_steps: int) -> None:
        """Bring the raw values back within the constraints after a step at softness `beta`."""
