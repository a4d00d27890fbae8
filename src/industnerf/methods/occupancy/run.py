"""Train the net, and ask it about a part, view by view."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from industnerf.artifacts.state import State
from industnerf.device import device
from industnerf.geometry.isosurface import isosurface_points
from industnerf.learning.augment import as_tensor
from industnerf.learning.frames import turns_of
from industnerf.learning.pictures import evenly, scaled
from industnerf.learning.training import set_apart, state_of, train
from industnerf.learning.weights import load_arrays, seeded
from industnerf.methods.answers import answered
from industnerf.methods.base import Example, Given, Reconstruction
from industnerf.methods.occupancy.lesson import Lesson
from industnerf.methods.occupancy.mise import mise
from industnerf.methods.occupancy.network import OccupancyNet
from industnerf.schema import OccupancySettings
from industnerf.seeds import generator

AT_ONCE = 16384  # points that the net is asked about in one go


def fit(
    examples: Sequence[Example], settings: OccupancySettings, seed: int, scratch: Path
) -> State:
    """Train on the parts that are not set apart; same seed, same bytes on a CPU."""
    torch.set_num_threads(1)  # folds are what runs side by side
    lesson = Lesson.of(examples, settings, generator(seed, "lessons"))
    with seeded(seed):
        net = OccupancyNet(settings).to(device())
    parts = set_apart([example.part_id for example in examples], settings.training.validation)
    checkpoint = scratch / "occupancy.pt"
    done = train(net, partial(lesson.loss, net), parts, settings.training, seed, checkpoint)
    return state_of(net, done, len(parts[0]), settings.size)


@torch.inference_mode()
def reconstruct(
    given: Given, settings: OccupancySettings, state: State, seed: int
) -> Reconstruction:
    """One answer a view, each of area-uniform points.

    Raises ReconstructionFailed if the net sees matter in none of the views.
    """
    torch.set_num_threads(1)  # parts are what runs side by side
    net = OccupancyNet(settings).to(device()).eval()
    load_arrays(net, state.arrays)
    chosen = evenly(len(given.rgb), settings.answers)
    codes = net.encode(as_tensor(scaled(given.rgb[chosen], settings.image_px), device()))
    turns, rng = turns_of(given.cameras[chosen], settings.frame), np.random.default_rng(seed)
    clouds = [surface(net, *seen, settings, rng) for seen in zip(codes, turns, strict=True)]
    return answered(clouds, given.frame, state)


def surface(
    net: OccupancyNet,
    code: Float[Tensor, "code"],
    turn: Float[np.ndarray, "3 3"],
    settings: OccupancySettings,
    rng: np.random.Generator,
) -> Float[np.ndarray, "_ 3"]:
    """Points where the probability of being inside, given `code`, is the threshold; maybe none.

    The net was taught of points @ `turn`.
    """
    level = float(np.log(settings.threshold / (1 - settings.threshold)))
    lo = np.full(3, -(1 + settings.padding) / 2)
    spacing = (1 + settings.padding) / (settings.cells * 2**settings.subdivisions)

    def field(corners: Int[np.ndarray, "p 3"]) -> Float[np.ndarray, "p"]:
        points = torch.from_numpy((lo + spacing * corners) @ turn).to(code).split(AT_ONCE)
        return torch.cat([net.decoder(some[None], code[None])[0] for some in points]).cpu().numpy()

    values, _ = mise(field, level, settings.cells, settings.subdivisions)
    return isosurface_points(values, level, lo, spacing, settings.points, rng)
