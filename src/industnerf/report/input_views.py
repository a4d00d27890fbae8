"""How many views of a part each method was really given, and how often it was asked."""

from dataclasses import dataclass
from typing import Any

from industnerf.methods.base import Input, Method

IMAGE_INPUTS = {Input.RGB, Input.MASK, Input.DEPTH}
# The setting that says it, of methods that are not given every view there is: so many views at most
# in one answer, or so many answers at most, each of one view.
LIMITED_BY = {
    "r2n2": "max_views",
    "retrieval": "views",
    "atlasnet": "eval_views",
    "occupancy": "eval_views",
}


@dataclass(frozen=True)
class InputViews:
    """What stands behind a score: the mean over `answers`, each of `each` views of the part."""

    views_per_prediction: int  # 0: no picture of the part
    num_predictions: int = 1


def input_views_of(method: Method, num_views: int, settings: Any) -> InputViews:
    """Of `count` views that there are; `settings` has the settings of methods, by their names."""
    if not IMAGE_INPUTS & method.inputs:
        return InputViews(0)
    if method.name not in LIMITED_BY:
        return InputViews(num_views)
    setting = LIMITED_BY[method.name]
    limit = min(num_views, getattr(getattr(settings, method.name), setting))
    return InputViews(1, limit) if setting == "eval_views" else InputViews(limit)
