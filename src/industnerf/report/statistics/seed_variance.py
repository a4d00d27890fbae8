"""Variance over seeds: of the points of a sweep, in `results/seeds`, and beside a study.

Mean EMD (even) over the test parts `part_subsets.seed_parts`, failures included, for each seed, and
the standard deviation of these means: to be held against differences between methods. Beside it the
same of a single part, as the root of the mean variance over the parts.

A later study shows the standard deviation only of a method that has, on these parts, the mean that
it had in the sweep: settings change under a name that stays.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isclose
from pathlib import Path
from statistics import fmean, stdev, variance

from industnerf.errors import BadArtifact
from industnerf.report.part_subsets import seed_parts
from industnerf.report.study import Study
from industnerf.report.tables.formats import csv_text, format_significant, markdown_table, read_csv
from industnerf.report.tables.scores import EMD_EVEN, scores_of, select_scores

EmdsBySeed = Mapping[int, Mapping[str, float]]  # seed -> part id -> EMD
EmdsByMethod = Mapping[str, Mapping[str, float]]  # method -> part id -> EMD with one seed
CSV_PRECISION = 1e-5  # relative: a mean as seeds.csv prints it


@dataclass(frozen=True)
class SeedVariance:
    """One method on the same parts with several seeds."""

    method: str
    parts: int
    means: dict[int, float]  # seed -> mean EMD
    mean: float  # over all seeds
    sd: float  # of these means
    part_sd: float  # of the EMD of one part
    mean_mm: float | None = None  # mean EMD with seed 0, each part in mm


def read_seed_sweeps(folders: Sequence[Path]) -> dict[str, dict[int, dict[str, float]]]:
    """Method -> seed -> part id -> EMD (even) of the fixed parts, from every point's report.

    Raises BadArtifact if a folder has no finished point.
    """
    emds: dict[str, dict[int, dict[str, float]]] = defaultdict(lambda: defaultdict(dict))
    for folder in folders:
        points = sorted(folder.glob("*/reports/scores.csv"))
        if not points:
            raise BadArtifact(f"{folder} has no */reports/scores.csv: no finished point of a sweep")
        for path in points:
            for row in fixed_part_rows(path):
                emds[row["method"]][int(row["seed"])][row["part_id"]] = float(row["value"])
    return emds


def fixed_part_rows(path: Path) -> list[dict[str, str]]:
    """The rows of a scores.csv that have the EMD (even) of the fixed parts."""
    rows = [
        row
        for row in read_csv(path)
        if (row["metric"], row["protocol"], row["split"]) == (*EMD_EVEN, "test")
    ]
    fixed = seed_parts({row["part_id"] for row in rows})
    return [row for row in rows if row["part_id"] in fixed]


def seed_variance(method: str, emds: EmdsBySeed) -> SeedVariance:
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
    return SeedVariance(
        method,
        len(parts),
        means,
        fmean(means.values()),
        stdev(means.values()),
        fmean(variances) ** 0.5,
    )


def seed_variances(folders: Sequence[Path]) -> list[SeedVariance]:
    """Of every method in the sweeps `folders`, the best first."""
    return sorted(
        (seed_variance(*each) for each in read_seed_sweeps(folders).items()), key=lambda s: s.mean
    )


def emds_with_seed_0(reports: Sequence[Path]) -> EmdsByMethod:
    """The EMDs (even) of the fixed parts with seed 0, from the scores.csv of each of `reports`."""
    emds: dict[str, dict[str, float]] = defaultdict(dict)
    for report in reports:
        for row in fixed_part_rows(report / "scores.csv"):
            if row["seed"] == "0":
                emds[row["method"]][row["part_id"]] = float(row["value"])
    return emds


def add_mean_mm(
    rows: Sequence[SeedVariance], emds_by_method: EmdsByMethod, diagonals_mm: Mapping[str, float]
) -> list[SeedVariance]:
    """`rows` with means in mm, for methods whose mean with seed 0 is that of `emds_by_method`.

    Others keep what they had: a later study may have other clouds than the sweep.
    """
    means_mm = {
        row.method: _mean_mm(row, emds_by_method.get(row.method, {}), diagonals_mm) for row in rows
    }
    return [replace(row, mean_mm=means_mm[row.method] or row.mean_mm) for row in rows]


def matches_run(row: SeedVariance, seed: int, emds: Mapping[str, float] | None) -> bool:
    """Whether `emds`, by fixed part, have the count and the mean of `row` with `seed`."""
    return (
        bool(emds)
        and len(emds) == row.parts
        and isclose(fmean(emds.values()), row.means.get(seed, inf), rel_tol=CSV_PRECISION)
    )


def _mean_mm(
    row: SeedVariance, emds: Mapping[str, float], diagonals_mm: Mapping[str, float]
) -> float | None:
    if not matches_run(row, 0, emds) or not emds.keys() <= diagonals_mm.keys():
        return None
    return fmean(emd * diagonals_mm[part] for part, emd in emds.items())


def read_seed_variances(folder: Path) -> list[SeedVariance]:
    """The rows that `seeds_csv` wrote into `folder`; empty if there is no such file."""
    path = folder / "seeds.csv"
    return [_parse_row(row) for row in read_csv(path)] if path.exists() else []


def _parse_row(row: dict[str, str]) -> SeedVariance:
    seeds = {name.removeprefix("seed_"): value for name, value in row.items() if value}
    means = {int(seed): float(value) for seed, value in seeds.items() if seed.isdigit()}
    mean, sd, part_sd = (float(row[name]) for name in ("mean", "sd", "part_sd"))
    mean_mm = float(row["seed_0_mm"]) if row.get("seed_0_mm") else None
    return SeedVariance(row["method"], int(row["parts"]), means, mean, sd, part_sd, mean_mm)


def _seed_columns(rows: Sequence[SeedVariance]) -> list[int]:
    return sorted({seed for row in rows for seed in row.means})


def _summary(row: SeedVariance) -> tuple[float, float, float]:
    return row.mean, row.sd, row.part_sd


def seeds_csv(rows: Sequence[SeedVariance]) -> str:
    """`seeds.csv`: method,parts,seed_0,...,mean,sd,part_sd,seed_0_mm."""
    seeds = _seed_columns(rows)
    return csv_text(
        ["method", "parts", *(f"seed_{n}" for n in seeds), "mean", "sd", "part_sd", "seed_0_mm"],
        [
            [row.method, row.parts, *map(row.means.get, seeds), *_summary(row), row.mean_mm]
            for row in rows
        ],
    )


def seeds_md(rows: Sequence[SeedVariance]) -> str:
    """`seeds.md`: the same for people."""
    seeds = _seed_columns(rows)
    table_rows = [
        [
            row.method,
            str(row.parts),
            *(f"{row.means[seed]:.5f}" if seed in row.means else "" for seed in seeds),
            *(f"{value:.5f}" for value in _summary(row)),
            format_significant(row.mean_mm),
        ]
        for row in rows
    ]
    heads = ["EMD (even)", "parts", *(f"seed {seed}" for seed in seeds)]
    return markdown_table(
        [*heads, "mean", "standard deviation", "of one part", "seed 0, mm"], table_rows
    )


def add_seed_variance(study: Study, folder: Path) -> Study:
    """`study` with the standard deviations in `folder` that belong to its methods."""
    emds = _fixed_part_emds(study)
    matching = [
        row
        for row in read_seed_variances(folder)
        if matches_run(row, study.seed, emds.get(row.method))
    ]
    return replace(study, seeds_sd={row.method: row.sd for row in matching})


def _fixed_part_emds(study: Study) -> EmdsByMethod:
    """The EMDs (even) of the fixed parts."""
    even_scores = {
        name: select_scores(scores_of(study, name, "test"), *EMD_EVEN) for name in study.methods
    }
    fixed = seed_parts({row.part_id for rows in even_scores.values() for row in rows})
    return {
        name: {row.part_id: row.score.value for row in rows if row.part_id in fixed}
        for name, rows in even_scores.items()
    }
