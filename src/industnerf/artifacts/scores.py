"""Scores: one row per part, metric and protocol; the same columns for success and for failure."""

import csv
import io
import math
from dataclasses import asdict, dataclass
from pathlib import Path

from industnerf.artifacts.files import read_json, write_json, write_text
from industnerf.errors import MetricError

SCHEMA = 2


@dataclass(frozen=True)
class Score:
    """One value; never NaN."""

    metric: str
    protocol: str  # e.g. P1-even
    value: float
    floor: float  # what a perfect method scores, or the best possible value
    unit: str  # diagonal (of the true bounding box), or share
    status: str  # ok, or failed: then the value is that of a trivial baseline
    floor_se: float | None = 0.0  # standard error of the floor; None: older results lack it

    def __post_init__(self) -> None:
        if not (math.isfinite(self.value) and math.isfinite(self.floor)):
            raise MetricError(
                f"{self.metric} {self.protocol} is {self.value}, its floor {self.floor}: both must "
                "be finite"
            )


@dataclass(frozen=True)
class PartScore:
    """A score and what it is of."""

    part_id: str
    method: str
    score: Score


def save_scores(folder: Path, scores: list[Score]) -> None:
    """Write the scores of one part."""
    write_json(folder / "scores.json", {"schema": SCHEMA, "scores": [asdict(s) for s in scores]})


def load_scores(folder: Path) -> list[Score]:
    """Read the scores of one part; raises BadArtifact if the file is missing or torn."""
    content = read_json(folder / "scores.json", SCHEMA, "evaluate")
    return [Score(**row) for row in content["scores"]]


def load_method_scores(folder: Path, method: str) -> list[PartScore]:
    """All scores of a method, by part id."""
    return [
        PartScore(path.parent.name, method, score)
        for path in sorted(folder.glob("*/scores.json"))
        for score in load_scores(path.parent)
    ]


def gather_scores(folder: Path, method: str) -> None:
    """Write `scores.csv` over all parts of a method, for people and spreadsheets."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["part_id", "method", *Score.__dataclass_fields__])
    for row in load_method_scores(folder, method):
        table.writerow([row.part_id, method, *vars(row.score).values()])
    write_text(folder / "scores.csv", text.getvalue())
