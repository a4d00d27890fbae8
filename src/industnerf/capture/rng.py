"""Random numbers of a view, drawn by name.

A draw depends on the base seed, its purpose, the part and the view's name, and on nothing else:
more views, another part or another random setting shift nobody's numbers.
"""

from dataclasses import dataclass

import numpy as np

from industnerf.schema import ViewsParams
from industnerf.seeds import generator


@dataclass(frozen=True)
class RandomStreams:
    """The random numbers of one view of one part."""

    seed: int
    part_id: str
    view: str  # "training 0" ... "held out 0" ...

    def generator(self, purpose: str) -> np.random.Generator:
        """A generator for this purpose alone, the same whenever asked for."""
        return generator(self.seed, "views", purpose, self.part_id, self.view)


def random_streams(seed: int, part_id: str, settings: ViewsParams) -> list[RandomStreams]:
    """One for each view, training views first.

    They are named apart, so that a held-out view keeps its draws when `views.count` changes.
    """
    names = [f"training {i}" for i in range(settings.count)]
    names += [f"held out {i}" for i in range(settings.held_out)]
    return [RandomStreams(seed, part_id, name) for name in names]


def is_random(settings: ViewsParams) -> bool:
    """Whether the photographs or their cameras depend on the seed."""
    light, sensor = settings.light, settings.sensor
    amplitudes = [light.rotation_jitter_deg, light.intensity_jitter, sensor.noise]
    amplitudes += [*vars(settings.jitter).values(), *vars(settings.calibration).values()]
    return settings.background == "random" or any(amplitudes)
