"""AtlasNet: a surface as squares of paper that a net bends, seen from one photograph.

Groueix et al., "A Papier-Mache Approach to Learning 3D Surface Generation" (2018), as the authors'
second code has it.  It sees one view at a time, so that several views give several answers.
What differs: parts fill the unit cube, not the unit ball; no mirror images; fewer parts by far;
batch norms keep their statistics in the last of the three trainings.
"""

from collections.abc import Sequence
from pathlib import Path

from industnerf.artifacts.state import State
from industnerf.methods.base import Example, Given, Input, Method, Reconstruction, Scope
from industnerf.schema import AtlasNetSettings


def fit(examples: Sequence[Example], settings: AtlasNetSettings, seed: int, scratch: Path) -> State:
    """Weights of the image encoder and the decoder, after three trainings."""
    # late: a report that names the method need not wait for torch
    from industnerf.methods.atlasnet.run import learned

    return learned(examples, settings, seed, scratch)


def reconstruct(
    given: Given, settings: AtlasNetSettings, state: State, seed: int
) -> Reconstruction:
    """An answer to each of `settings.answers` views, evenly chosen."""
    from industnerf.learning.frames import turns_of
    from industnerf.learning.pictures import evenly, scaled
    from industnerf.methods.answers import answered
    from industnerf.methods.atlasnet.run import clouds

    chosen = evenly(len(given.rgb), settings.answers)
    images = scaled(given.rgb[chosen], settings.image_px)
    turns = turns_of(given.cameras[chosen], settings.frame)
    return answered(clouds(images, turns, settings, state, seed), given.frame, state)


METHODS = {
    "atlasnet": Method(
        "atlasnet",
        Scope.DATASET,
        frozenset({Input.RGB, Input.FRAME, Input.OTHER_MESHES}),
        reconstruct,
        fit,
        random=True,
    )
}
