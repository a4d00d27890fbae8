"""The training loop: Adam, validation, early stopping, checkpoint, resume."""

import hashlib
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from industnerf.artifacts.history import History
from industnerf.errors import ReconstructionFailed
from industnerf.learning import checkpoint
from industnerf.schema import TrainingSettings
from industnerf.seeds import generator

# Loss of a batch: parts by index, maybe more than once; what else is drawn comes from the rng.
Loss = Callable[[Int[np.ndarray, "batch"], np.random.Generator], Float[Tensor, ""]]
CHECKPOINT_S = 20.0
WARM_UP_STEPS = 100  # over which the learning rate rises to its full value
LAST_LR = 0.01  # of the full learning rate, at the end of its half cosine
MAX_GRADIENT_NORM = 5.0  # longer gradients are shortened to this
NORM_SHARE = 0.75  # of the steps: batch norm then keeps its statistics
# converged: in the last fifth of the steps the loss fell by at most 2 %
CONVERGENCE_WINDOW, CONVERGENCE_TOLERANCE = 0.2, 0.02
VALIDATION_REPEATS = 4  # how often each part is validated on, rounded up to whole batches


@runtime_checkable
class GroupedPart(Protocol):
    """A part to learn from, as `industnerf.methods.base.Example` is."""

    @property
    def part_id(self) -> str: ...

    @property
    def group(self) -> str: ...


@dataclass
class TrainingProgress:
    """A training between two of its steps."""

    step: int = 0
    train_losses: list[float] = field(default_factory=list)
    val_steps: list[int] = field(default_factory=list)  # after so many steps ...
    val_losses: list[float] = field(default_factory=list)  # ... the loss was this
    best_weights: dict[str, Tensor] = field(default_factory=dict)  # those with the least val loss

    @property
    def validations_since_best(self) -> int:
        """Validations since the best one."""
        return len(self.val_losses) - 1 - int(np.argmin(self.val_losses)) if self.val_losses else 0


@dataclass(frozen=True)
class TrainResult:
    """How a training went."""

    steps: int
    has_converged: bool
    train_history: History
    val_history: History


def train_val_split(
    examples: Sequence[GroupedPart], val_share: float
) -> tuple[list[int], list[int]]:
    """Indices of the parts to learn from and of those to validate on: whole groups, by hash.

    Groups are set apart until they hold the share `val_share` of all parts; one group at least, and
    never all.  A single group is split by part.  Of a single part both: there is nothing else.
    """
    groups = [example.group for example in examples]
    if len(set(groups)) == 1:
        groups = [example.part_id for example in examples]
    if len(groups) == 1:
        return [0], [0]
    val_groups: set[str] = set()
    for group in sorted(set(groups), key=_hash)[:-1]:
        if sum(map(val_groups.__contains__, groups)) >= max(1, round(val_share * len(groups))):
            break
        val_groups.add(group)
    val_ids = [i for i, group in enumerate(groups) if group in val_groups]
    return [i for i in range(len(groups)) if i not in val_ids], val_ids


def _hash(name: str) -> str:
    return hashlib.sha256(f"validation/{name}".encode()).hexdigest()


@dataclass(frozen=True)
class TrainingSplit:
    """Indices of the shapes that are learned from and validated on."""

    train: list[int]
    val: list[int]
    solids: list[int] = field(default_factory=list)  # if there are any, half of every batch


def train(
    net: nn.Module,
    loss: Loss,
    split: TrainingSplit,
    settings: TrainingSettings,
    seed: int,
    checkpoint_path: Path,
    *,
    starts_trained: bool = False,
) -> TrainResult:
    """Train `net` by `loss`, and keep the best weights on the validation parts, or the last ones.

    The learning rate rises over WARM_UP_STEPS and falls as half a cosine.  Batch norm learns its
    statistics over NORM_SHARE of the steps, and keeps them for the rest.  Weights that were trained
    before (`starts_trained`) bring theirs, and are validated too: they may be the best.  Parameters
    that need no gradient stay as they are.  It resumes from `checkpoint_path` where that exists, to
    the same bytes on a CPU.

    Raises ReconstructionFailed if a loss is not finite, BadArtifact if `checkpoint_path` cannot be
    written.
    """
    trainer = _Trainer(net, loss, split, settings, seed, starts_trained)
    trainer.resume(checkpoint_path)
    if starts_trained and not trainer.progress.val_steps:
        trainer.validate()
    last_saved = time.monotonic()
    while not trainer.is_finished:
        trainer.train_step()
        if time.monotonic() - last_saved > CHECKPOINT_S:
            trainer.save(checkpoint_path)
            last_saved = time.monotonic()
    trainer.save(checkpoint_path)
    if settings.keep == "best":
        net.load_state_dict(trainer.progress.best_weights)
    return trainer.result()


class _Trainer:
    def __init__(
        self,
        net: nn.Module,
        loss: Loss,
        split: TrainingSplit,
        settings: TrainingSettings,
        seed: int,
        starts_trained: bool,
    ) -> None:
        self.net, self.loss, self.split = net, loss, split
        self.settings, self.seed = settings, seed
        self.norm_steps = 0 if starts_trained else NORM_SHARE * settings.max_steps
        self.rng, self.progress = generator(seed, "batches"), TrainingProgress()
        self.parameters = [p for p in net.parameters() if p.requires_grad]
        # only weights decay: a bias or a scale that is pulled to 0 regularizes nothing
        groups = [
            {
                "params": [p for p in self.parameters if (p.ndim > 1) == decays],
                "weight_decay": decay,
            }
            for decays, decay in ((True, settings.weight_decay), (False, 0.0))
        ]
        self.optimizer = torch.optim.Adam(groups, settings.lr)

    @property
    def is_finished(self) -> bool:
        return (
            self.progress.step >= self.settings.max_steps
            or self.progress.validations_since_best >= self.settings.patience
        )

    def train_step(self) -> None:
        """One step, and a validation where one is due."""
        for group in self.optimizer.param_groups:
            group["lr"] = self.settings.lr * lr_factor(self.progress.step, self.settings.max_steps)
        self.net.train()
        if self.progress.step >= self.norm_steps:
            _keep_norm_statistics(self.net)
        self.optimizer.zero_grad()
        loss = self.loss(self._draw_batch(), self.rng)
        loss.backward()
        nn.utils.clip_grad_norm_(self.parameters, MAX_GRADIENT_NORM)
        self.optimizer.step()
        self.progress.step += 1
        self.progress.train_losses.append(self._require_finite("training", loss.item()))
        if self.progress.step % self.settings.val_interval == 0 or self.is_finished:
            self.validate()

    def _draw_batch(self) -> Int[np.ndarray, "batch"]:
        size = self.settings.batch_size
        if not self.split.solids:
            return self.rng.choice(self.split.train, size)
        parts = self.rng.choice(self.split.train, size - size // 2)
        return np.concatenate([parts, self.rng.choice(self.split.solids, size // 2)])

    @torch.no_grad()
    def validate(self) -> None:
        """The loss on the validation parts: the same draws every time, so that losses compare."""
        self.net.eval()
        rng, batch = generator(self.seed, "validation"), self.settings.batch_size
        batches = math.ceil(VALIDATION_REPEATS * len(self.split.val) / batch)
        val_batches = np.resize(self.split.val, batches * batch)
        losses = [self.loss(batch_ids, rng).item() for batch_ids in val_batches.reshape(-1, batch)]
        self.progress.val_steps.append(self.progress.step)
        self.progress.val_losses.append(self._require_finite("validation", float(np.mean(losses))))
        if self.progress.validations_since_best == 0:
            self.progress.best_weights = {k: v.clone() for k, v in self.net.state_dict().items()}

    def _require_finite(self, kind: str, loss: float) -> float:
        if not math.isfinite(loss):
            raise ReconstructionFailed(
                f"the {kind} loss is {loss} at step {self.progress.step} of "
                f"{self.settings.max_steps}: the training diverged; lower the learning "
                f"rate (training.lr of the method is {self.settings.lr:g})"
            )
        return loss

    def save(self, path: Path) -> None:
        """Write all that the rest of the training depends on."""
        state = {
            "progress": vars(self.progress),
            "net": self.net.state_dict(),
            "optimizer": self.optimizer.state_dict(),
            "rng": self.rng.bit_generator.state,
        }
        checkpoint.save(path, state)

    def resume(self, path: Path) -> None:
        """Go on from what `save` wrote, if it is there and can be read."""
        state = checkpoint.load(path)
        if state is None:
            return
        self.progress = TrainingProgress(**state["progress"])
        self.net.load_state_dict(state["net"])
        self.optimizer.load_state_dict(state["optimizer"])
        self.rng.bit_generator.state = state["rng"]

    def result(self) -> TrainResult:
        """The summary of a finished training."""
        progress = self.progress
        # the weights that a training starts from are none of its own, unless they are what is kept
        goes_on = self.settings.keep == "last" and progress.step > 0
        first = int(goes_on and progress.val_steps[:1] == [0])
        return TrainResult(
            progress.step,
            has_converged(progress.val_steps[first:], progress.val_losses[first:]),
            History(np.arange(progress.step), np.array(progress.train_losses), {}),
            # weights that were trained before are validated before the first step
            History(
                np.maximum(np.array(progress.val_steps) - 1, 0), np.array(progress.val_losses), {}
            ),
        )


def _keep_norm_statistics(net: nn.Module) -> None:
    """Batch norm as in evaluation: by the statistics that it has, not by those of the batch.

    Otherwise no training sees the network as it predicts.  A shape unlike others shifts the
    statistics of its own batch and so tames what it excites; alone, it has nothing to tame it.
    """
    for module in net.modules():
        if isinstance(module, nn.BatchNorm1d | nn.BatchNorm2d):
            module.eval()


def lr_factor(step: int, max_steps: int) -> float:
    """The learning rate of a step, of the full one."""
    cosine = (1 + math.cos(math.pi * step / max_steps)) / 2
    return min(1.0, (step + 1) / WARM_UP_STEPS) * (LAST_LR + (1 - LAST_LR) * cosine)


def has_converged(steps: Sequence[int], losses: Sequence[float]) -> bool:
    """Whether the best loss fell by at most 2 % in the last fifth of the steps taken.

    False where no loss is known before that.
    """
    before = [
        loss
        for step, loss in zip(steps, losses, strict=True)
        if step <= (1 - CONVERGENCE_WINDOW) * steps[-1]
    ]
    return bool(before) and min(losses) >= (1 - CONVERGENCE_TOLERANCE) * min(before)
