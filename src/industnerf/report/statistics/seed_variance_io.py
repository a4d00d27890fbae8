"""`results/seeds`: what was found of the spread over seeds, written and read back."""

from collections.abc import Sequence
from pathlib import Path

from industnerf.report.statistics.seed_variance import SeedVariance
from industnerf.report.tables.formats import csv_text, format_significant, markdown_table, read_csv


def read_seed_variances(folder: Path) -> list[SeedVariance]:
    """What `seeds_csv` wrote into `folder`; nothing where there is none."""
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


def _summary_values(row: SeedVariance) -> tuple[float, float, float]:
    return row.mean, row.sd, row.part_sd


def seeds_csv(rows: Sequence[SeedVariance]) -> str:
    """`seeds.csv`: method,parts,seed_0,...,mean,sd,part_sd,seed_0_mm."""
    seeds = _seed_columns(rows)
    return csv_text(
        [
            "method",
            "parts",
            *(f"seed_{seed}" for seed in seeds),
            "mean",
            "sd",
            "part_sd",
            "seed_0_mm",
        ],
        [
            [
                row.method,
                row.parts,
                *map(row.means.get, seeds),
                row.mean,
                row.sd,
                row.part_sd,
                row.mean_mm,
            ]
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
            *(f"{value:.5f}" for value in _summary_values(row)),
            format_significant(row.mean_mm),
        ]
        for row in rows
    ]
    heads = ["EMD (even)", "parts", *(f"seed {seed}" for seed in seeds)]
    return markdown_table(
        [*heads, "mean", "standard deviation", "of one part", "seed 0, mm"], table_rows
    )
