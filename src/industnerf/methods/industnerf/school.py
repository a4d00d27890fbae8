"""E and N's start, learned from the images of other parts: reading R14 `shared`.

One E and one N re-render several parts side by side, each on the points of its own warm-up.  The
signal is the paper's: no mesh is looked at, of the part itself not even an image.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from statistics import fmean

import numpy as np
import torch

from industnerf.artifacts.history import History
from industnerf.artifacts.state import State
from industnerf.device import device
from industnerf.learning import checkpoint
from industnerf.learning.training import settled
from industnerf.learning.weights import arrays_of, seeded
from industnerf.methods.industnerf.field import Field
from industnerf.methods.industnerf.levels import WARM_UP, Layer, grid, spacing_of
from industnerf.methods.industnerf.pair import Pair
from industnerf.methods.industnerf.scene import Posed, Scene, scene_of
from industnerf.methods.industnerf.training import Training
from industnerf.schema import IndustnerfSettings
from industnerf.seeds import seed_for


def schooled(
    pupils: Sequence[Posed], settings: IndustnerfSettings, seed: int, scratch: Path
) -> State:
    """The weights of E and N after `settings.school`; goes on after the last term in `scratch`.

    Raises ReconstructionFailed if the field of a part becomes empty.
    """
    torch.set_num_threads(1)  # folds are what runs side by side
    ways = _of_a_class(settings, len(pupils))
    scenes = [scene_of(posed, device()) for posed in pupils]
    pair, losses = _new_pair(scenes[0], ways, seed), []
    finished = scratch / "school.pt"
    saved = checkpoint.load(finished)
    if saved is not None:
        pair.load_state_dict(saved["pair"])
        losses = saved["losses"]
    while len(losses) < ways.school.terms:
        losses.append(_term(pair, scenes, ways, seed_for(seed, "term", str(len(losses)))))
        checkpoint.save(finished, {"pair": pair.state_dict(), "losses": losses})
    return _state(pair, losses, len(pupils), ways.warm_up.steps)


def _of_a_class(settings: IndustnerfSettings, pupils: int) -> IndustnerfSettings:
    """E learns here, at its rate divided by the number of parts: each of them takes a step of it.

    What a part's views were encoded to goes stale with every step of E, whoever takes it.
    """
    readings = replace(settings.readings, encoder="per_part")
    rate = settings.network.encoder_rate / pupils
    network = replace(settings.network, encoder_rate=rate)
    return replace(settings, readings=readings, network=network)


def _new_pair(scene: Scene, ways: IndustnerfSettings, seed: int) -> Pair:
    with seeded(seed):
        return Pair(Field(scene, ways).to(device()))


def _term(pair: Pair, scenes: Sequence[Scene], ways: IndustnerfSettings, seed: int) -> list[float]:
    """The mean loss over the parts at every step of a warm-up that all of them take together."""
    generator = torch.Generator().manual_seed(seed)
    trainings = [_training(pair, scene, ways, generator) for scene in scenes]
    return [fmean(one.step() for one in trainings) for _ in range(ways.warm_up.steps)]


def _training(
    pair: Pair, scene: Scene, ways: IndustnerfSettings, generator: torch.Generator
) -> Training:
    spacing = spacing_of(ways.grid_res, WARM_UP)
    field = Field(scene, ways).to(device())
    pair.lend(field)
    return Training(scene, field, Layer(grid(spacing, device()), spacing), WARM_UP, ways, generator)


def _state(pair: Pair, losses: Sequence[Sequence[float]], parts: int, steps: int) -> State:
    every = [loss for term in losses for loss in term]
    ends = [steps * (number + 1) for number in range(len(losses))]
    return State(
        arrays_of(pair),
        parts,
        parameters=sum(weights.numel() for weights in pair.parameters()),
        steps=len(every),
        settled=settled(ends, [fmean(term) for term in losses]),
        history=History(
            np.arange(len(every)),
            np.array(every),
            {f"term {number}": end - steps for number, end in enumerate(ends)},
        ),
    )
