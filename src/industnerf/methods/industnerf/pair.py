"""E and N by themselves: what one part may learn and another may start from, reading R14."""

from collections.abc import Mapping

import numpy as np
import torch
from torch import nn

from industnerf.methods.industnerf.field import Field


class Pair(nn.Module):
    """The encoder and the network of a field."""

    def __init__(self, field: Field) -> None:
        super().__init__()
        self.encoder, self.network = field.sources.encoder, field.network

    def lend(self, field: Field) -> None:
        """Have `field` use these two, and train them, in place of its own."""
        field.sources.encoder, field.network = self.encoder, self.network

    def arrays(self) -> dict[str, np.ndarray]:
        """All weights by name."""
        return {name: weights.cpu().numpy() for name, weights in self.state_dict().items()}

    def load(self, arrays: Mapping[str, np.ndarray]) -> None:
        """Take over what `arrays` gave of another pair of the same settings."""
        self.load_state_dict({name: torch.from_numpy(array) for name, array in arrays.items()})
