"""What came of a run: how far from a known solid it is, its bytes, and what was told on the way."""

import copy
from typing import Any

import numpy as np
from scipy.spatial import cKDTree
from torch import Tensor

from industnerf.methods.industnerf.run import Outcome, Watch
from tests.methods.industnerf.scenes import CENTRE, Solid, ball, box, texture

SOLIDS = {"ball": ball(18.0), "box": box((16.0, 11.0, 8.0))}


def surface_of(solid: Solid, count: int = 2000) -> np.ndarray:
    """Points all over it."""
    directions = np.random.default_rng(0).normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return directions * (100 - solid.meets(100 * directions, -directions))[:, None]


def errors(solid: Solid, outcome: Outcome, within: float = 4.0) -> tuple[float, float, float]:
    """Mean distance of the points from the surface, mm; the share of the surface that has one
    `within` so many mm; the mean error of the colours."""
    points = outcome.points - CENTRE
    near = cKDTree(points).query(surface_of(solid))[0] < within
    off = np.abs(outcome.colours / 255 - texture(points)).mean()
    return np.abs(solid.away(points)).mean(), near.mean(), off


def bytes_of(outcome: Outcome) -> bytes:
    fields = (outcome.points, outcome.colours, outcome.confidence, outcome.view)
    return b"".join(values.tobytes() for values in fields) + str(outcome.losses).encode()


class Recorder(Watch):
    """Remembers all that it is told, and asks for everything."""

    def __init__(self) -> None:
        self.begun: list[tuple[str, int]] = []
        self.losses: list[float] = []
        self.states: list[dict[str, Any]] = []
        self.seen: list[tuple[np.ndarray, np.ndarray]] = []

    def begin(self, level: str, steps: int) -> None:
        self.begun.append((level, steps))

    def step(self, loss: Tensor) -> None:
        self.losses.append(loss.item())

    def wants_preview(self) -> bool:
        return True

    def preview(self, source: np.ndarray, rendered: np.ndarray) -> None:
        self.seen.append((source, rendered))

    def wants_checkpoint(self) -> bool:
        return True

    def checkpoint(self, state: dict[str, Any]) -> None:
        self.states.append(copy.deepcopy(state))
