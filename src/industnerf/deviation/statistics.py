"""What an inspection report says of signed distances from CAD."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

BINS = 61  # of the histogram, an odd number: 0 is in the middle of one


@dataclass(frozen=True)
class DeviationStatistics:
    """Of the points that are no strays; lengths in mm, shares of those points."""

    points: int
    strays: int  # farther from the surface than counts
    stray_mm: float
    tolerance_mm: float
    within_tolerance: float
    above: float  # outside the surface by more than the tolerance
    below: float  # inside it
    mean_mm: float
    std_mm: float
    rms_mm: float
    median_abs_mm: float
    p95_abs_mm: float
    max_mm: float
    min_mm: float
    covered: float  # of the CAD surface, the share with a point near
    covered_mm: float  # how near


def deviation_statistics(
    deviation: Float[np.ndarray, "n"],
    tolerance_mm: float,
    stray_mm: float,
    gaps: Float[np.ndarray, "m"],
    covered_mm: float,
) -> DeviationStatistics:
    """Of signed distances; `gaps` are those of even samples of the surface to the cloud."""
    kept = deviation[np.abs(deviation) <= stray_mm]
    size = np.abs(kept)
    return DeviationStatistics(
        points=len(deviation),
        strays=len(deviation) - len(kept),
        stray_mm=stray_mm,
        tolerance_mm=tolerance_mm,
        within_tolerance=float((size <= tolerance_mm).mean()),
        above=float((kept > tolerance_mm).mean()),
        below=float((kept < -tolerance_mm).mean()),
        mean_mm=float(kept.mean()),
        std_mm=float(kept.std()),
        rms_mm=float(np.sqrt((kept**2).mean())),
        median_abs_mm=float(np.median(size)),
        p95_abs_mm=float(np.quantile(size, 0.95)),
        max_mm=float(kept.max()),
        min_mm=float(kept.min()),
        covered=float((gaps <= covered_mm).mean()),
        covered_mm=covered_mm,
    )


def histogram(
    deviation: Float[np.ndarray, "n"], end_mm: float
) -> tuple[Int[np.ndarray, "bins"], Float[np.ndarray, "edges"]]:
    """Counts of bins of one width from -`end_mm` to `end_mm`; the last ones hold all beyond."""
    edges = np.linspace(-end_mm, end_mm, BINS + 1)
    return np.histogram(np.clip(deviation, -end_mm, end_mm), edges)[0], edges
