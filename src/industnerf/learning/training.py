"""The loop that every net is trained with: Adam, validation, early stopping, checkpoint, resume."""

import hashlib
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from industnerf.artifacts.history import History
from industnerf.artifacts.state import State
from industnerf.errors import ReconstructionFailed
from industnerf.learning import checkpoint
from industnerf.learning.weights import arrays_of
from industnerf.schema import TrainingSettings
from industnerf.seeds import generator

# Loss of a batch: parts by index, maybe more than once; what else is drawn comes from the rng.
Loss = Callable[[Int[np.ndarray, "batch"], np.random.Generator], Float[Tensor, ""]]
CHECKPOINT_S = 20.0
LAST, LITTLE = 0.2, 0.02  # settled: in the last fifth of the steps at most 2 % were gained
VALIDATIONS = 4  # how often each part is validated on, rounded up to whole batches


@dataclass
class Progress:
    """A training between two of its steps."""

    step: int = 0
    losses: list[float] = field(default_factory=list)
    validated: list[int] = field(default_factory=list)  # after so many steps ...
    validation: list[float] = field(default_factory=list)  # ... the loss was this
    best: dict[str, Tensor] = field(default_factory=dict)  # the weights with the least of them

    @property
    def stale(self) -> int:
        """Validations since the best one."""
        return len(self.validation) - 1 - int(np.argmin(self.validation)) if self.validation else 0


@dataclass(frozen=True)
class Trained:
    """How a training went; the net has the weights that were best on the validation parts."""

    steps: int
    settled: bool
    history: History
    validation: History


def set_apart(part_ids: Sequence[str], share: float) -> tuple[list[int], list[int]]:
    """Indices of the parts to learn from and of those to validate on, by hash, at least one each.

    Of a single part both: there is nothing else.
    """
    order = sorted(range(len(part_ids)), key=lambda i: _hash(part_ids[i]))
    if len(order) == 1:
        return order, order
    count = min(max(1, round(share * len(order))), len(order) - 1)
    return sorted(order[count:]), sorted(order[:count])


def _hash(name: str) -> str:
    return hashlib.sha256(f"validation/{name}".encode()).hexdigest()


def train(
    net: nn.Module,
    loss: Loss,
    parts: tuple[list[int], list[int]],
    settings: TrainingSettings,
    seed: int,
    path: Path,
) -> Trained:
    """Train `net` by `loss` on the parts `parts[0]`, and keep what is best on `parts[1]`.

    Parameters that need no gradient stay as they are.  It goes on from the checkpoint `path`
    where that exists, to the same bytes on a CPU.

    Raises ReconstructionFailed if a loss is not finite, BadArtifact if `path` cannot be written.
    """
    loop = _Loop(net, loss, parts, settings, seed)
    loop.resume(path)
    saved = time.monotonic()
    while not loop.finished:
        loop.advance()
        if time.monotonic() - saved > CHECKPOINT_S:
            loop.save(path)
            saved = time.monotonic()
    loop.save(path)
    net.load_state_dict(loop.now.best)
    return loop.trained()


class _Loop:
    def __init__(
        self,
        net: nn.Module,
        loss: Loss,
        parts: tuple[list[int], list[int]],
        settings: TrainingSettings,
        seed: int,
    ) -> None:
        self.net, self.loss, self.settings, self.seed = net, loss, settings, seed
        self.taught, self.asked = (np.array(some) for some in parts)
        self.rng, self.now = generator(seed, "batches"), Progress()
        learning = [p for p in net.parameters() if p.requires_grad]
        # only weights decay: a bias or a scale that is pulled to 0 regularises nothing
        groups = [
            {"params": [p for p in learning if p.ndim > 1], "weight_decay": settings.weight_decay},
            {"params": [p for p in learning if p.ndim <= 1], "weight_decay": 0.0},
        ]
        self.adam = torch.optim.Adam(groups, settings.rate)

    @property
    def finished(self) -> bool:
        return self.now.step >= self.settings.steps or self.now.stale >= self.settings.patience

    def advance(self) -> None:
        """One step, and a validation where one is due."""
        drops = sum(self.now.step >= share * self.settings.steps for share in self.settings.drops)
        for group in self.adam.param_groups:
            group["lr"] = self.settings.rate * 0.1**drops
        self.net.train()
        self.adam.zero_grad()
        loss = self.loss(self.rng.choice(self.taught, self.settings.batch), self.rng)
        loss.backward()
        self.adam.step()
        self.now.step += 1
        self.now.losses.append(self._finite("training", loss.item()))
        if self.now.step % self.settings.validate_every == 0 or self.finished:
            self._validate()

    @torch.no_grad()
    def _validate(self) -> None:
        """The loss on the validation parts: the same draws every time, so that losses compare."""
        self.net.eval()
        rng, batch = generator(self.seed, "validation"), self.settings.batch
        batches = math.ceil(VALIDATIONS * len(self.asked) / batch)
        which = np.resize(self.asked, batches * batch)
        losses = [self.loss(some, rng).item() for some in which.reshape(-1, batch)]
        self.now.validated.append(self.now.step)
        self.now.validation.append(self._finite("validation", float(np.mean(losses))))
        if self.now.stale == 0:
            self.now.best = {k: v.clone() for k, v in self.net.state_dict().items()}

    def _finite(self, kind: str, loss: float) -> float:
        if not math.isfinite(loss):
            raise ReconstructionFailed(
                f"the {kind} loss is {loss} at step {self.now.step} of {self.settings.steps}: the "
                f"training diverged; its rate (training.rate of the method) is "
                f"{self.settings.rate:g}, lower it"
            )
        return loss

    def save(self, path: Path) -> None:
        """Write all that the rest of the training depends on."""
        state = {
            "now": vars(self.now),
            "net": self.net.state_dict(),
            "adam": self.adam.state_dict(),
            "rng": self.rng.bit_generator.state,
        }
        checkpoint.save(path, state)

    def resume(self, path: Path) -> None:
        """Go on from what `save` wrote, if it is there and can be read."""
        state = checkpoint.load(path)
        if state is None:
            return
        self.now = Progress(**state["now"])
        self.net.load_state_dict(state["net"])
        self.adam.load_state_dict(state["adam"])
        self.rng.bit_generator.state = state["rng"]

    def trained(self) -> Trained:
        """The summary of a training that is over."""
        now = self.now
        return Trained(
            now.step,
            settled(now.validated, now.validation),
            History(np.arange(now.step), np.array(now.losses), {}),
            History(np.array(now.validated) - 1, np.array(now.validation), {}),
        )


def state_of(net: nn.Module, how: Trained, parts: int, size: str) -> State:
    """What is kept of `net`, which learned from so many parts."""
    return State(
        arrays_of(net),
        parts,
        size,
        parameters=sum(weights.numel() for weights in net.parameters()),
        steps=how.steps,
        settled=how.settled,
        history=how.history,
        validation=how.validation,
    )


def settled(steps: Sequence[int], losses: Sequence[float]) -> bool:
    """Whether the best loss fell by at most 2 % in the last fifth of the steps taken.

    It is not where none is known of before that.
    """
    before = [
        loss for step, loss in zip(steps, losses, strict=True) if step <= (1 - LAST) * steps[-1]
    ]
    return bool(before) and min(losses) >= (1 - LITTLE) * min(before)
