"""How far results move with the seed, from the points of a sweep over it.

Mean EMD (even) over SEED_PARTS fixed test parts, failures included, for each seed, and the standard
deviation of these means: to be held against differences between methods.  Beside it the same of a
single part, as the root of the mean variance over the parts.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean, stdev, variance

from industnerf.errors import BadArtifact
from industnerf.report.formats import csv_rows, csv_text, markdown
from industnerf.report.lookup import EVEN
from industnerf.report.subsets import SEED_PARTS, by_hash

Emds = Mapping[int, Mapping[str, float]]  # seed -> part id -> EMD


@dataclass(frozen=True)
class Spread:
    """One method over the same parts with several seeds."""

    method: str
    parts: int
    means: dict[int, float]  # seed -> mean EMD
    sd: float  # of these means
    part_sd: float  # of the EMD of one part

    @property
    def mean(self) -> float:
        """Over all seeds."""
        return fmean(self.means.values())


def read_sweeps(folders: Sequence[Path]) -> dict[str, dict[int, dict[str, float]]]:
    """Method -> seed -> part id -> EMD (even) of the fixed parts, from every point's report.

    Raises BadArtifact if a folder has no finished point.
    """
    found: dict[str, dict[int, dict[str, float]]] = defaultdict(lambda: defaultdict(dict))
    for folder in folders:
        points = sorted(folder.glob("*/reports/scores.csv"))
        if not points:
            raise BadArtifact(f"{folder} has no */reports/scores.csv: no finished point of a sweep")
        for path in points:
            for row in _fixed_parts(path):
                found[row["method"]][int(row["seed"])][row["part_id"]] = float(row["value"])
    return found


def _fixed_parts(path: Path) -> list[dict[str, str]]:
    rows = [
        row
        for row in csv_rows(path)
        if (row["metric"], row["protocol"], row["split"]) == (*EVEN, "test")
    ]
    fixed = set(by_hash("seeds", {row["part_id"] for row in rows})[:SEED_PARTS])
    return [row for row in rows if row["part_id"] in fixed]


def spread(method: str, emds: Emds) -> Spread:
    """Raises BadArtifact if there is one seed alone, or the seeds have not the same parts."""
    if len(emds) < 2:
        raise BadArtifact(f"{method}: a spread needs two seeds or more, found {sorted(emds)}")
    parts = sorted(next(iter(emds.values())))
    for seed, values in emds.items():
        if sorted(values) != parts:
            different = ", ".join(sorted(set(parts) ^ set(values)))
            raise BadArtifact(f"{method}: seed {seed} has not the same parts: {different}")
    means = {seed: fmean(emds[seed].values()) for seed in sorted(emds)}
    variances = [variance([values[part] for values in emds.values()]) for part in parts]
    return Spread(method, len(parts), means, stdev(means.values()), fmean(variances) ** 0.5)


def spreads(folders: Sequence[Path]) -> list[Spread]:
    """Of every method in the sweeps `folders`, the best first."""
    return sorted((spread(*each) for each in read_sweeps(folders).items()), key=lambda s: s.mean)


def _columns(rows: Sequence[Spread]) -> list[int]:
    return sorted({seed for row in rows for seed in row.means})


def seeds_csv(rows: Sequence[Spread]) -> str:
    """`seeds.csv`: method,parts,seed_0,...,mean,sd,part_sd."""
    seeds = _columns(rows)
    return csv_text(
        ["method", "parts", *(f"seed_{seed}" for seed in seeds), "mean", "sd", "part_sd"],
        [
            [row.method, row.parts, *map(row.means.get, seeds), row.mean, row.sd, row.part_sd]
            for row in rows
        ],
    )


def seeds_md(rows: Sequence[Spread]) -> str:
    """`seeds.md`: the same for people."""
    seeds = _columns(rows)
    lines = [
        [
            row.method,
            str(row.parts),
            *(f"{row.means[seed]:.5f}" if seed in row.means else "" for seed in seeds),
            *(f"{value:.5f}" for value in (row.mean, row.sd, row.part_sd)),
        ]
        for row in rows
    ]
    heads = ["EMD (even)", "parts", *(f"seed {seed}" for seed in seeds)]
    return markdown([*heads, "mean", "standard deviation", "of one part"], lines)
