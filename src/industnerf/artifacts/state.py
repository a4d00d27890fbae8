"""What a method has learned from other parts: a net's weights, or whatever it keeps of them."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from industnerf.artifacts.files import read_json, read_npz, write_json
from industnerf.artifacts.history import History

SCHEMA = 1
SUMMARY = ("parts", "size", "parameters", "steps", "settled")


@dataclass(frozen=True)
class State:
    """Arrays by name, and how they came about."""

    arrays: dict[str, np.ndarray]
    parts: int  # that it was learned from
    size: str = ""  # of a net: full is as published; see `method.<name>.size` in params.yaml
    parameters: int = 0  # trained numbers
    steps: int = 0  # optimisation steps taken
    settled: bool = True  # false: the validation loss was still falling when the steps were over
    history: History | None = None  # of the training loss
    validation: History | None = None  # of the validation loss, each at its training step

    def save(self, folder: Path) -> None:
        """Write `state.json`, `state.npz` and the histories into `folder`."""
        content = {"schema": SCHEMA} | {name: getattr(self, name) for name in SUMMARY}
        write_json(folder / "state.json", content | {"arrays": sorted(self.arrays)})
        np.savez_compressed(folder / "state.npz", **self.arrays)
        if self.history is not None:
            self.history.save(folder)
        if self.validation is not None:
            (folder / "validation").mkdir()
            self.validation.save(folder / "validation")

    @staticmethod
    def load(folder: Path) -> "State":
        """Read what `save` wrote; raises BadArtifact if a file is missing or torn."""
        content = read_json(folder / "state.json", SCHEMA, "train")
        names = tuple(content.pop("arrays"))
        del content["schema"]
        arrays = dict(zip(names, read_npz(folder / "state.npz", names, "train"), strict=True))
        history = History.load(folder, "train")
        validation = History.load(folder / "validation", "train")
        return State(arrays, **content, history=history, validation=validation)

    @staticmethod
    def summary(folder: Path) -> dict:
        """All but the arrays and the histories, without reading them."""
        content = read_json(folder / "state.json", SCHEMA, "train")
        return {name: content[name] for name in SUMMARY}
