"""What one run of MLflow is to hold, before MLflow is asked."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import UInt8


@dataclass(frozen=True)
class Dataset:
    """The parts that the values of a run are of, or that a network learned from."""

    name: str
    context: str  # test, dev or training
    digest: str
    source: str
    num_parts: int
    num_families: int


@dataclass(frozen=True)
class Run:
    """A run and those below it."""

    name: str
    tags: Mapping[str, str]
    params: Mapping[str, Any] = field(default_factory=dict)
    metrics: Mapping[str, float] = field(default_factory=dict)
    curves: Mapping[str, Mapping[int, float]] = field(default_factory=dict)  # name: step: value
    table: Any = None  # a data frame with a row per part
    preview: UInt8[np.ndarray, "h w 3"] | None = None
    artifacts: tuple[tuple[Path, str], ...] = ()  # file or folder, and the folder it is copied to
    datasets: tuple[Dataset, ...] = ()
    children: Iterable["Run"] = ()  # made while they are logged: pictures of a sweep fill memory
