"""docs/results/claims.md: the limitations that the paper names in 5.1 and does not measure."""

from collections.abc import Iterator
from pathlib import Path

from industnerf.report.docs.claim import (
    FAILS,
    HOLDS,
    METHOD,
    UNDECIDED,
    Claim,
    goal_values,
    verdict_of,
)
from industnerf.report.docs.study_results import mean_seconds, test_rows_by_method
from industnerf.report.tables.costs import seconds_label
from industnerf.report.tables.formats import read_csv
from industnerf.report.tables.goals import MEMORY

REAL_TIME_SECONDS = 1.0


def cost_limits(study: Path, sweeps: Path) -> Iterator[Claim]:
    """Time and memory of one part, and how they grow with its faces."""
    memory, seconds = goal_values(study).get(MEMORY), mean_seconds(study).get(METHOD)
    if memory is not None and seconds is not None:
        yield Claim(
            "5.1",
            "not fit for real time",
            HOLDS if seconds > REAL_TIME_SECONDS else FAILS,
            f"{seconds:.0f} {seconds_label(read_csv(study / 'cost.csv'))} a part, "
            f"at most {memory:.1f} GB",
        )
    trend = sweeps / "sweep-complexity" / "trend.csv"
    for row in read_csv(trend) if trend.exists() else []:
        if (row["series"], row["quantity"]) == (METHOD, "seconds"):
            exponent, error = float(row["exponent"]), float(row["standard error"])
            yield Claim(
                "5.1",
                "cost may grow faster than linearly with complexity",
                verdict_of(*(1 - exponent + side * 1.96 * error for side in (-1, 1))),
                f"seconds grow by the {exponent:.2f}th power (standard error {error:.2f}) of the "
                f"faces, over {row['points']} parts",
            )


def organic_limit(study: Path) -> Iterator[Claim]:
    """Whether it is farther from its floor on organic shapes than on industrial parts."""
    organic = study.with_name("organic")
    rows = [
        test_rows_by_method(folder).get(METHOD) for folder in (study, organic) if folder.exists()
    ]
    if len(rows) == 2 and all(rows):
        industrial, other = (float(row["ratio_to_floor"]) for row in rows if row)
        parts = rows[1]["parts"] if rows[1] else ""
        yield Claim(
            "5.1",
            "worse on shapes that are not industrial",
            UNDECIDED,
            f"{other:.2f} floors on the organic set of {parts} parts, {industrial:.2f} on the "
            "study's; too few families for a test",
        )


def noise_limit(sweeps: Path) -> Iterator[Claim]:
    """EMD with the strongest noise against none, on too few parts for a test."""
    path = sweeps / "sweep-noise-nerf" / "sweep.csv"
    rows = [row for row in read_csv(path) if row["method"] == METHOD] if path.exists() else []
    if rows:
        clean, noisy = (float(row["emd"]) for row in (rows[0], rows[-1]))
        yield Claim(
            "5.1",
            "sensitive to noise in the images",
            UNDECIDED,
            f"EMD {clean:.4f} without, {noisy:.4f} with a standard deviation of "
            f"{rows[-1]['views.sensor.noise']}; four dev parts are too few for a test",
        )
