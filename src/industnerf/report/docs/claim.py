"""One claim of the paper beside what is measured of it, and what claims are judged by."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from industnerf.report import paper_results
from industnerf.report.tables.formats import optional_float, read_csv

HOLDS, FAILS, UNDECIDED = "holds", "does not hold", "cannot be told"
HEADS = ("section", "claim", "verdict", "measured")
METHOD = paper_results.METHOD
MIN_FAMILIES = 6  # by flipping signs, two-sided, p is 2 / 2**5 = 0.06 at best with one fewer

CsvRow = dict[str, str]


@dataclass(frozen=True)
class Claim:
    """One claim, and what is measured of it."""

    section: str
    text: str
    verdict: str
    measured: str

    def cells(self) -> tuple[str, ...]:
        """One for each of HEADS."""
        return self.section, self.text, f"**{self.verdict}**", self.measured


def verdict_of(low: float | None, high: float | None, families: int = MIN_FAMILIES) -> str:
    """The verdict on "less": by whether the interval of a difference lies below or above 0.

    Without an interval, or from too few families for a test, nothing can be told.
    """
    if low is None or high is None or families < MIN_FAMILIES:
        return UNDECIDED
    if high < 0:
        return HOLDS
    return FAILS if low > 0 else UNDECIDED


def interval_of(row: CsvRow) -> tuple[float | None, float | None]:
    """Low and high of the interval of a published difference; None where it has none."""
    return optional_float(row["ci_low"]), optional_float(row["ci_high"])


def goal_values(study: Path) -> dict[str, float]:
    """The values of the goals of the paper's method, by what is measured."""
    rows: Sequence[CsvRow] = read_csv(study / "goals.csv")
    return {row["goal"]: float(row["value"]) for row in rows if row["method"] == METHOD}
