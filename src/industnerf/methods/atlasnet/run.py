"""Three trainings, and what the net says of a photograph after them."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, UInt8
from torch import Tensor, nn

from industnerf.artifacts.history import History
from industnerf.artifacts.state import State
from industnerf.device import device
from industnerf.learning.augment import as_tensor
from industnerf.learning.training import Trained, set_apart, state_of, train
from industnerf.learning.weights import load_arrays, seeded
from industnerf.methods.atlasnet.lessons import Lessons
from industnerf.methods.atlasnet.network import AtlasNet, PointNet, decoder_of, image_encoder_of
from industnerf.methods.atlasnet.patches import grid, sampled
from industnerf.methods.base import Example
from industnerf.schema import AtlasNetSettings, TrainingSettings
from industnerf.seeds import generator, seed_for

PHASES = ("auto_encoder", "encoder", "together")
LAST_RATE = 0.1  # of the last phase, where all that has learned already learns on


def learned(
    examples: Sequence[Example], settings: AtlasNetSettings, seed: int, scratch: Path
) -> State:
    """The net for pictures, trained as published: training/launcher.py of the authors' code."""
    torch.set_num_threads(1)  # folds are what runs side by side
    lessons = Lessons(examples, settings, generator(seed, "lessons"))
    reader, net = new_nets(settings, seed)
    parts = set_apart([one.part_id for one in examples], settings.training.validation)
    plans = dict(zip(PHASES, planned(settings), strict=True))

    def phase(name: str, what: AtlasNet) -> Trained:
        teach = lessons.from_points if what is reader else lessons.from_pictures
        own = seed_for(seed, "phase", name)
        return train(what, partial(teach, what), parts, plans[name], own, scratch / f"{name}.pt")

    phases = [phase("auto_encoder", reader)]
    # its weights alone: the statistics of its batch norms follow what the new encoder says
    net.decoder.requires_grad_(False)
    phases.append(phase("encoder", net))
    net.decoder.requires_grad_(True)
    # A batch of few parts has statistics of its own: a net that learns to live with those may
    # answer far off with the running ones.  In the end it learns with the ones it answers with.
    net.frozen = True
    phases.append(phase("together", net))
    return kept(net, settings, len(parts[0]), phases)


def new_nets(settings: AtlasNetSettings, seed: int) -> tuple[AtlasNet, AtlasNet]:
    """One that reads points and one that reads pictures; they share their decoder."""
    with seeded(seed):
        decoder = decoder_of(settings)
        nets = [AtlasNet(PointNet(settings.latent), decoder)]
        nets.append(AtlasNet(image_encoder_of(settings), decoder))
    reader, net = (one.to(device()) for one in nets)
    return reader, net


def planned(settings: AtlasNetSettings) -> list[TrainingSettings]:
    """The settings of each phase, which share the steps; in the last, rates fall but once."""
    whole, total = settings.training, sum(settings.phases)
    steps = [max(1, round(whole.steps * share / total)) for share in settings.phases]
    plans = [replace(whole, steps=count) for count in steps]
    return [*plans[:2], replace(plans[2], rate=LAST_RATE * whole.rate, drops=whole.drops[:1])]


def kept(net: nn.Module, settings: AtlasNetSettings, parts: int, phases: list[Trained]) -> State:
    """What is kept of a net and of its trainings, one after the other."""
    starts = np.cumsum([0] + [one.steps for one in phases])
    whole = Trained(
        int(starts[-1]),
        all(one.settled for one in phases[1:]),
        _joined([one.history for one in phases], starts),
        _joined([one.validation for one in phases], starts),
    )
    return state_of(net, whole, parts, settings.size)


def _joined(histories: list[History], starts: np.ndarray) -> History:
    return History(
        np.concatenate([one.steps + at for one, at in zip(histories, starts[:-1], strict=True)]),
        np.concatenate([one.loss for one in histories]),
        dict(zip(PHASES, starts.tolist(), strict=False)),
    )


def clouds(
    images: UInt8[np.ndarray, "n px px 3"],
    turns: Float[np.ndarray, "n 3 3"],
    settings: AtlasNetSettings,
    state: State,
    seed: int,
) -> list[Float[np.ndarray, "points 3"]]:
    """The answer to each image: area-uniform points of all patches, in the unit cube.

    What the net gives for an image is points @ its turn.
    """
    torch.set_num_threads(1)
    net = AtlasNet(image_encoder_of(settings), decoder_of(settings)).to(device()).eval()
    load_arrays(net, state.arrays)
    uv, faces = grid(settings.grid)
    squares = torch.tensor(uv.T, dtype=torch.float32, device=device())
    rng = np.random.default_rng(seed)
    shown = as_tensor(images, device())
    meshes = (_vertices(net, image, squares, settings.patches) for image in shown)
    return [
        sampled(vertices @ turn.T, faces, settings.points, rng)
        for vertices, turn in zip(meshes, turns, strict=True)
    ]


@torch.no_grad()
def _vertices(
    net: AtlasNet, image: Float[Tensor, "3 px px"], squares: Float[Tensor, "2 n"], patches: int
) -> Float[np.ndarray, "{patches} n 3"]:
    points = net(image[None], squares[None, :, None].expand(patches, -1, -1, -1))
    return points.view(patches, -1, 3).cpu().numpy().astype(np.float64)
