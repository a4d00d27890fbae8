"""Section 3.1, E and N pretrained on the images of other parts: reading R14 `pretrained`.

One E and one N are trained to re-render several parts, each on its own warm-up points.  The loss
is the paper's; no mesh is used, and no image of the part to reconstruct.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from statistics import fmean

import numpy as np
import torch

from industnerf.artifacts.history import History
from industnerf.artifacts.state import ModelState
from industnerf.device import device
from industnerf.learning import checkpoint
from industnerf.learning.training import has_converged
from industnerf.learning.weights import state_arrays, torch_seed
from industnerf.methods.industnerf.field import Field, SharedModules
from industnerf.methods.industnerf.point_levels import (
    WARM_UP,
    PointLevel,
    grid_spacing,
    initial_grid,
)
from industnerf.methods.industnerf.scene import NerfScene, PosedImages, make_scene
from industnerf.methods.industnerf.trainer import Trainer
from industnerf.schema import IndustnerfSharedSettings
from industnerf.seeds import seed_for
from industnerf.torch_kernels import use_reproducible_kernels


def pretrain(
    training_parts: Sequence[PosedImages],
    settings: IndustnerfSharedSettings,
    seed: int,
    scratch: Path,
) -> ModelState:
    """Weights of E and N after all epochs; resumes from the last one stored in `scratch`.

    Raises ReconstructionFailed if the field of a part becomes empty.
    """
    use_reproducible_kernels()  # folds are what runs side by side
    settings = _with_divided_lr(settings, len(training_parts))
    scenes = [make_scene(posed, device()) for posed in training_parts]
    shared_modules, losses = _new_modules(scenes[0], settings, seed), []
    checkpoint_path = scratch / "pretraining.pt"
    checkpointed = checkpoint.load(checkpoint_path)
    if checkpointed is not None:
        shared_modules.load_state_dict(checkpointed["modules"])
        losses = checkpointed["losses"]
    while len(losses) < settings.pretraining.epochs:
        epoch_seed = seed_for(seed, "term", str(len(losses)))
        losses.append(_train_epoch(shared_modules, scenes, settings, epoch_seed))
        checkpoint.save(checkpoint_path, {"modules": shared_modules.state_dict(), "losses": losses})
    return _model_state(shared_modules, losses, len(training_parts), settings.warm_up.steps)


def _with_divided_lr(
    settings: IndustnerfSharedSettings, num_parts: int
) -> IndustnerfSharedSettings:
    """The settings with E trained, at its learning rate divided by the number of parts.

    Every part takes a step of E, and each step makes the encoded views of all parts staler.
    """
    readings = replace(settings.readings, encoder="per_part")
    lr = settings.network.encoder_lr / num_parts
    network = replace(settings.network, encoder_lr=lr)
    return replace(settings, readings=readings, network=network)


def _new_modules(scene: NerfScene, settings: IndustnerfSharedSettings, seed: int) -> SharedModules:
    with torch_seed(seed):
        return SharedModules(Field(scene, settings).to(device()))


def _train_epoch(
    shared_modules: SharedModules,
    scenes: Sequence[NerfScene],
    settings: IndustnerfSharedSettings,
    seed: int,
) -> list[float]:
    """Mean loss over the parts at every step of a warm-up that they take side by side."""
    generator = torch.Generator().manual_seed(seed)
    trainers = [_make_trainer(shared_modules, scene, settings, generator) for scene in scenes]
    return [fmean(trainer.step() for trainer in trainers) for _ in range(settings.warm_up.steps)]


def _make_trainer(
    shared_modules: SharedModules,
    scene: NerfScene,
    settings: IndustnerfSharedSettings,
    generator: torch.Generator,
) -> Trainer:
    spacing = grid_spacing(settings.grid_res, WARM_UP)
    field = Field(scene, settings).to(device())
    shared_modules.share_with(field)
    return Trainer(
        scene,
        field,
        PointLevel(initial_grid(spacing, device()), spacing),
        WARM_UP,
        settings,
        generator,
    )


def _model_state(
    shared_modules: SharedModules,
    losses: Sequence[Sequence[float]],
    num_parts: int,
    steps_per_epoch: int,
) -> ModelState:
    all_losses = [loss for epoch_losses in losses for loss in epoch_losses]
    ends = [steps_per_epoch * (epoch + 1) for epoch in range(len(losses))]
    return ModelState(
        state_arrays(shared_modules),
        num_parts,
        num_parameters=sum(weights.numel() for weights in shared_modules.parameters()),
        steps=len(all_losses),
        converged=has_converged(ends, [fmean(epoch_losses) for epoch_losses in losses]),
        train_history=History(
            np.arange(len(all_losses)),
            np.array(all_losses),
            {f"epoch {epoch}": end - steps_per_epoch for epoch, end in enumerate(ends)},
        ),
    )
