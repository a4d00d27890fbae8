"""A report as the runs of MLflow need it: read once, and only what is asked for."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from industnerf.artifacts.split import SplitAssignment, load_split
from industnerf.stage import read_index
from industnerf.store import content_digest
from industnerf.tracking.run import Dataset
from industnerf.tracking.scores import read_costs, read_part_scores, read_table1
from industnerf.tracking.tags import load_tags


@dataclass(frozen=True)
class Report:
    """The report in `folder`, made with `params`."""

    folder: Path
    params: Mapping[str, Any]

    @cached_property
    def results(self) -> str:
        """A digest that reports with the same scores share."""
        return content_digest([self.folder / "table1.csv", self.folder / "scores.csv"])

    @cached_property
    def scores(self) -> Any:
        return read_part_scores(self.folder)

    @cached_property
    def table1(self) -> Any:
        return read_table1(self.folder)

    @cached_property
    def training_costs(self) -> Any:
        return read_costs(self.folder, "train")

    @cached_property
    def tags(self) -> dict[str, str]:
        """Those of every run of the report."""
        known = {"preset": str(self.table1.preset[0]), "results": self.results}
        return known | load_tags(self.folder)

    @cached_property
    def split(self) -> str:
        """The parts whose means are the metrics: dev where there are no test parts."""
        return "test" if (self.scores.split == "test").any() else "dev"

    @property
    def data(self) -> Path:
        """What the stages before the report wrote; published results have none."""
        return self.folder.parent / "data"

    @cached_property
    def assignments(self) -> dict[str, SplitAssignment]:
        path = self.data / "split.json"
        return load_split(path) if path.exists() else {}

    @cached_property
    def part_keys(self) -> dict[str, list[str]]:
        """The store's keys of the mesh and the photographs of every part, where known."""
        folders = [self.data / name for name in ("parts", "views")]
        indices = [read_index(path) for path in folders if (path / "index.json").exists()]
        return {part: [index.get(part, "") for index in indices] for part in self.families}

    @cached_property
    def families(self) -> dict[str, str]:
        return dict(zip(self.scores.part_id, self.scores.family, strict=True))

    def methods(self) -> list[str]:
        """The method of the smallest EMD first."""
        return list(self.table1[self.table1.split == self.split].method)

    def dataset(self, parts: list[str], context: str) -> Dataset:
        """`parts` as a dataset, told from others by their meshes and photographs."""
        source = str(self.params.get("parts", {}).get("path", "unknown"))
        content = json.dumps([(part, self.part_keys[part]) for part in sorted(parts)])
        digest = hashlib.sha256(content.encode()).hexdigest()[:16]
        num_families = len({self.families[part] for part in parts})
        return Dataset(Path(source).name, context, digest, source, len(parts), num_families)
