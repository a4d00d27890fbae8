"""How many views of a part each method was really given, and how often it was asked."""

from dataclasses import dataclass
from typing import Any

from industnerf.methods.base import Input, Method

PICTURES = {Input.RGB, Input.MASK, Input.DEPTH}
# The setting that says it, of methods that are not given every view there is: so many views at most
# in one answer, or so many answers at most, each of one view.
SAID_BY = {"r2n2": "views", "retrieval": "views", "atlasnet": "answers", "occupancy": "answers"}


@dataclass(frozen=True)
class Views:
    """What stands behind a score: the mean over `answers`, each of `each` views of the part."""

    each: int  # 0: no picture of the part
    answers: int = 1


def views_of(method: Method, count: int, settings: Any) -> Views:
    """Of `count` views that there are; `settings` has the settings of methods, by their names."""
    if not PICTURES & method.inputs:
        return Views(0)
    if method.name not in SAID_BY:
        return Views(count)
    said_by = SAID_BY[method.name]
    most = min(count, getattr(getattr(settings, method.name), said_by))
    return Views(1, most) if said_by == "answers" else Views(most)
