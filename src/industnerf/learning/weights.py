"""The weights of a network: seeded, saved as arrays, loaded again."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import numpy as np
import torch
from torch import nn


@contextmanager
def torch_seed(seed: int) -> Iterator[None]:
    """What torch draws on the CPU within the block depends on `seed` alone."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        yield


def state_arrays(net: nn.Module) -> dict[str, np.ndarray]:
    """All weights and buffers of `net` by name."""
    return {name: tensor.cpu().numpy() for name, tensor in net.state_dict().items()}


def load_arrays(net: nn.Module, arrays: Mapping[str, np.ndarray]) -> None:
    """Load what `state_arrays` gave of another network of the same settings."""
    net.load_state_dict({name: torch.tensor(array) for name, array in arrays.items()})
