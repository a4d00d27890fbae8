"""What a metric says."""

from dataclasses import dataclass


@dataclass(frozen=True)
class MetricValue:
    """One metric under one protocol."""

    metric: str
    protocol: str
    value: float
    unit: str
    smaller_is_better: bool = True
