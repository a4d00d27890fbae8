"""Fit a network to parts, starting from what it learned before."""

from collections.abc import Sequence
from pathlib import Path

from torch import nn

from industnerf.artifacts.state import ModelState
from industnerf.errors import BadParams
from industnerf.learning.training import Loss, TrainingSplit, TrainResult, train, train_val_split
from industnerf.learning.training_shape import Prior, TrainingShape
from industnerf.learning.weights import load_arrays, state_arrays
from industnerf.schema import TrainingSettings


def fit_network(
    net: nn.Module,
    loss: Loss,
    examples: Sequence[TrainingShape],
    prior: Prior,
    settings: TrainingSettings,
    seed: int,
    checkpoint_path: Path,
    size: str,
) -> ModelState:
    """The state of `net`, trained on `examples` and on the solids of `prior`, from its weights.

    `loss` knows the shapes by their place in [*examples, *prior.solids].  Without any example this
    is pretraining: solids are learned from and validated on.  The state counts the shapes that
    were learned from, but not the solids beside examples; `size` is a name for its settings.

    Raises BadParams if the weights are of a network of other sizes, and what `train` raises.
    """
    if prior.weights is not None:
        _load_prior_weights(net, prior.weights)
    train_ids, val_ids = train_val_split(examples or prior.solids, settings.val_fraction)
    solid_ids = list(range(len(examples), len(examples) + len(prior.solids))) if examples else []
    split = TrainingSplit(train_ids, val_ids, solid_ids)
    result = train(
        net, loss, split, settings, seed, checkpoint_path, starts_trained=prior.weights is not None
    )
    return model_state(net, result, len(train_ids), size)


def _load_prior_weights(net: nn.Module, weights: ModelState) -> None:
    try:
        load_arrays(net, weights.arrays)
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[-1].strip()
        raise BadParams(
            f"the pretrained weights are of a network of size {weights.size!r} and do not fit this "
            f"one ({reason}): the method's sizes were changed; set pretrain.weights to trained, "
            "or to none"
        ) from None


def model_state(net: nn.Module, result: TrainResult, num_parts: int, size: str) -> ModelState:
    """The state of `net`, which was trained on `num_parts` parts."""
    return ModelState(
        state_arrays(net),
        num_parts,
        size,
        num_parameters=sum(weights.numel() for weights in net.parameters()),
        steps=result.steps,
        converged=result.has_converged,
        train_history=result.train_history,
        val_history=result.val_history,
    )
