"""`results/seeds`: what was found of the spread over seeds, written and read back."""

from collections.abc import Sequence
from pathlib import Path

from industnerf.report.formats import brief, csv_rows, csv_text, markdown
from industnerf.report.spread import Spread


def read_seeds(folder: Path) -> list[Spread]:
    """What `seeds_csv` wrote into `folder`; nothing where there is none."""
    path = folder / "seeds.csv"
    return [_spread(row) for row in csv_rows(path)] if path.exists() else []


def _spread(row: dict[str, str]) -> Spread:
    seeds = {name.removeprefix("seed_"): value for name, value in row.items() if value}
    means = {int(seed): float(value) for seed, value in seeds.items() if seed.isdigit()}
    mean, sd, part_sd = (float(row[name]) for name in ("mean", "sd", "part_sd"))
    mm = float(row["seed_0_mm"]) if row.get("seed_0_mm") else None
    return Spread(row["method"], int(row["parts"]), means, mean, sd, part_sd, mm)


def _columns(rows: Sequence[Spread]) -> list[int]:
    return sorted({seed for row in rows for seed in row.means})


def _of_all(row: Spread) -> tuple[float, float, float]:
    return row.mean, row.sd, row.part_sd


def seeds_csv(rows: Sequence[Spread]) -> str:
    """`seeds.csv`: method,parts,seed_0,...,mean,sd,part_sd,seed_0_mm."""
    seeds = _columns(rows)
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
                row.mm,
            ]
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
            *(f"{value:.5f}" for value in _of_all(row)),
            brief(row.mm),
        ]
        for row in rows
    ]
    heads = ["EMD (even)", "parts", *(f"seed {seed}" for seed in seeds)]
    return markdown([*heads, "mean", "standard deviation", "of one part", "seed 0, mm"], lines)
