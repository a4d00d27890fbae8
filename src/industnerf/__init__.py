"""IndustNeRF: industrial CAD parts from images, its baselines, and how they are measured."""

from typing import Any

from industnerf import processor

processor.pin()  # numeric libraries read their environment as they load


def __getattr__(name: str) -> Any:
    """`emd`, loaded when it is asked for: whoever imports the package waits for no library."""
    if name == "emd":
        from industnerf.metrics.emd import emd

        return emd
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
