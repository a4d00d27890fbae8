"""AtlasNet's three trainings, and its prediction from photographs."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Int, UInt8
from torch import Tensor, nn

from industnerf.artifacts.history import History
from industnerf.artifacts.state import ModelState
from industnerf.device import device
from industnerf.geometry.sampling import sample_surface
from industnerf.learning.augment import images_to_tensor
from industnerf.learning.training import TrainResult, model_state, train, train_val_split
from industnerf.learning.weights import load_arrays, torch_seed
from industnerf.methods.atlasnet.dataset import AtlasNetDataset
from industnerf.methods.atlasnet.network import (
    AtlasNet,
    PointNet,
    build_decoder,
    build_image_encoder,
)
from industnerf.methods.base import Example
from industnerf.schema import AtlasNetSettings, TrainingSettings
from industnerf.seeds import generator, seed_for
from industnerf.torch_kernels import use_reproducible_kernels

PHASES = ("auto_encoder", "encoder", "together")
LAST_PHASE_LR_FACTOR = 0.1  # of the last phase, which fine-tunes all weights


def train_phases(
    examples: Sequence[Example], settings: AtlasNetSettings, seed: int, scratch: Path
) -> ModelState:
    """The network for images, trained as published: training/launcher.py of the authors' code."""
    use_reproducible_kernels()  # folds are what runs side by side
    dataset = AtlasNetDataset(examples, settings, generator(seed, "lessons"))
    autoencoder, net = new_nets(settings, seed)
    split = train_val_split(examples, settings.training.val_fraction)
    settings_by_phase = dict(zip(PHASES, phase_settings(settings), strict=True))

    def phase(name: str, model: AtlasNet) -> TrainResult:
        loss = dataset.autoencoder_loss if model is autoencoder else dataset.image_loss
        phase_seed = seed_for(seed, "phase", name)
        return train(
            model,
            partial(loss, model),
            split,
            settings_by_phase[name],
            phase_seed,
            scratch / f"{name}.pt",
        )

    phases = [phase("auto_encoder", autoencoder)]
    # its weights alone: the statistics of its batch norms follow the new encoder
    net.decoder.requires_grad_(False)
    phases.append(phase("encoder", net))
    net.decoder.requires_grad_(True)
    # A batch of few parts has statistics of its own, and a network trained with those may predict
    # far off with the running ones.  So the last phase trains with the ones it predicts with.
    net.has_frozen_batch_norm = True
    phases.append(phase("together", net))
    return merged_state(net, settings, len(split[0]), phases)


def new_nets(settings: AtlasNetSettings, seed: int) -> tuple[AtlasNet, AtlasNet]:
    """One that encodes points and one that encodes images; they share their decoder."""
    with torch_seed(seed):
        decoder = build_decoder(settings)
        nets = [AtlasNet(PointNet(settings.latent_dim), decoder)]
        nets.append(AtlasNet(build_image_encoder(settings), decoder))
    autoencoder, net = (one.to(device()) for one in nets)
    return autoencoder, net


def phase_settings(settings: AtlasNetSettings) -> list[TrainingSettings]:
    """The settings of each phase, which share the steps; in the last, rates fall but once."""
    training, total = settings.training, sum(settings.phase_fractions)
    steps = [
        max(1, round(training.max_steps * share / total)) for share in settings.phase_fractions
    ]
    phases = [replace(training, max_steps=count) for count in steps]
    return [
        *phases[:2],
        replace(
            phases[2],
            lr=LAST_PHASE_LR_FACTOR * training.lr,
            lr_milestones=training.lr_milestones[:1],
        ),
    ]


def merged_state(
    net: nn.Module, settings: AtlasNetSettings, num_parts: int, phases: list[TrainResult]
) -> ModelState:
    """The state of a network after its trainings, one after the other."""
    starts = np.cumsum([0] + [one.steps for one in phases])
    combined = TrainResult(
        int(starts[-1]),
        all(one.has_converged for one in phases[1:]),
        _concatenated([one.train_history for one in phases], starts),
        _concatenated([one.val_history for one in phases], starts),
    )
    return model_state(net, combined, num_parts, settings.size)


def _concatenated(histories: list[History], starts: np.ndarray) -> History:
    return History(
        np.concatenate([one.steps + at for one, at in zip(histories, starts[:-1], strict=True)]),
        np.concatenate([one.loss for one in histories]),
        dict(zip(PHASES, starts.tolist(), strict=False)),
    )


def predict_clouds(
    images: UInt8[np.ndarray, "n px px 3"],
    rotations: Float[np.ndarray, "n 3 3"],
    settings: AtlasNetSettings,
    state: ModelState,
    seed: int,
) -> list[Float[np.ndarray, "points 3"]]:
    """The prediction from each image: area-uniform points of all patches, in the unit cube.

    The network predicts points @ rotation.
    """
    use_reproducible_kernels()
    net = AtlasNet(build_image_encoder(settings), build_decoder(settings)).to(device()).eval()
    load_arrays(net, state.arrays)
    uv, faces = square_mesh(settings.grid_res)
    squares = torch.tensor(uv.T, dtype=torch.float32, device=device())
    rng = np.random.default_rng(seed)
    tensors = images_to_tensor(images, device())
    meshes = (_vertices(net, image, squares, settings.patches) for image in tensors)
    return [
        sample_patches(vertices @ rotation.T, faces, settings.points, rng)
        for vertices, rotation in zip(meshes, rotations, strict=True)
    ]


@torch.no_grad()
def _vertices(
    net: AtlasNet, image: Float[Tensor, "3 px px"], squares: Float[Tensor, "2 n"], patches: int
) -> Float[np.ndarray, "{patches} n 3"]:
    points = net(image[None], squares[None, :, None].expand(patches, -1, -1, -1))
    return points.view(patches, -1, 3).cpu().numpy().astype(np.float64)


def square_mesh(side: int) -> tuple[Float[np.ndarray, "n 2"], Int[np.ndarray, "m 3"]]:
    """`side`^2 regular points of the unit square, its border included, and its triangles."""
    u, v = np.meshgrid(*2 * [np.linspace(0, 1, side)], indexing="ij")
    corner = np.arange(side * side).reshape(side, side)
    a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    faces = np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)
    return np.stack([u.ravel(), v.ravel()], axis=1), faces


def sample_patches(
    vertices: Float[np.ndarray, "patches n 3"],
    faces: Int[np.ndarray, "m 3"],
    count: int,
    rng: np.random.Generator,
) -> Float[np.ndarray, "count 3"]:
    """`count` area-uniform points of all patches together, which share their triangles.

    Patches may overlap; where they do there are more points, for nothing tells which one to drop.
    """
    vertex_offsets = np.arange(len(vertices))[:, None, None] * vertices.shape[1]
    return sample_surface(
        vertices.reshape(-1, 3), (faces + vertex_offsets).reshape(-1, 3), count, rng
    )[0]
