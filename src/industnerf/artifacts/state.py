"""What a method has learned from other parts: a network's weights, or whatever it keeps of them."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from industnerf.artifacts.files import read_json, read_npz, write_json
from industnerf.artifacts.history import History

SCHEMA = 2
SUMMARY_FIELDS = ("num_parts", "size", "num_parameters", "steps", "converged")


@dataclass(frozen=True)
class ModelState:
    """Arrays by name, and how they came about."""

    arrays: dict[str, np.ndarray]
    num_parts: int  # that it was learned from
    size: str = ""  # of a net: full is as published; see `method.<name>.size` in params.yaml
    num_parameters: int = 0  # trained numbers
    steps: int = 0  # optimization steps taken
    converged: bool = True  # false: the validation loss was still falling when the steps were over
    train_history: History | None = None  # of the training loss
    val_history: History | None = None  # of the validation loss, each at its training step

    def save(self, folder: Path) -> None:
        """Write `state.json`, `state.npz` and the histories into `folder`."""
        content = {"schema": SCHEMA} | {name: getattr(self, name) for name in SUMMARY_FIELDS}
        write_json(folder / "state.json", content | {"arrays": sorted(self.arrays)})
        np.savez_compressed(folder / "state.npz", **self.arrays)
        if self.train_history is not None:
            self.train_history.save(folder)
        if self.val_history is not None:
            (folder / "validation").mkdir(exist_ok=True)
            self.val_history.save(folder / "validation")

    @staticmethod
    def load(folder: Path) -> "ModelState":
        """Read what `save` wrote; raises BadArtifact if a file is missing or torn."""
        content = read_json(folder / "state.json", SCHEMA, "train")
        names = tuple(content.pop("arrays"))
        del content["schema"]
        arrays = dict(zip(names, read_npz(folder / "state.npz", names, "train"), strict=True))
        train_history = History.load(folder, "train")
        val_history = History.load(folder / "validation", "train")
        return ModelState(arrays, **content, train_history=train_history, val_history=val_history)

    @staticmethod
    def summary(folder: Path) -> dict:
        """All but the arrays and the histories, without reading them."""
        content = read_json(folder / "state.json", SCHEMA, "train")
        return {name: content[name] for name in SUMMARY_FIELDS}
