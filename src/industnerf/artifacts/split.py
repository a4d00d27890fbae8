"""Which parts are tuned on, which are reported, and which network reconstructs which part."""

from dataclasses import dataclass
from pathlib import Path

from industnerf.artifacts.files import read_json, write_json

SCHEMA = 2


@dataclass(frozen=True)
class SplitAssignment:
    """Where one part stands."""

    split: str  # "dev": tuned on, in no headline mean; "test": reported
    fold: int | None  # the part is reconstructed by a network trained without this fold; None: any

    @property
    def net_name(self) -> str:
        """The name of the network that reconstructs the part."""
        return "all" if self.fold is None else f"fold-{self.fold}"


def train_parts(assignments: dict[str, SplitAssignment], net_name: str) -> list[str]:
    """The ids of the parts that the network `net_name` is trained on."""
    return sorted(
        part
        for part, assignment in assignments.items()
        if net_name == "all" or assignment.net_name != net_name
    )


def save_split(path: Path, assignments: dict[str, SplitAssignment]) -> None:
    """Write the assignment of every part id."""
    write_json(
        path, {"schema": SCHEMA, "parts": {part: vars(one) for part, one in assignments.items()}}
    )


def load_split(path: Path) -> dict[str, SplitAssignment]:
    """Read the assignment of every part id; raises BadArtifact if the file is missing or torn."""
    return {
        part: SplitAssignment(**assignment)
        for part, assignment in read_json(path, SCHEMA, "split")["parts"].items()
    }
