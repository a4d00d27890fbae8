"""What a value of params.yaml may be, beside its type: `Annotated[int, at_least(1)]`.

Rules of one value stand beside its type, and `config.build` checks them.  What several values
must be to each other, a section says in its `__post_init__` with `require`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from operator import ge, gt, le, lt
from typing import Annotated, Any

from industnerf.errors import BadValue


@dataclass(frozen=True)
class Rule:
    holds: Callable[[Any], bool]
    words: str  # "must be ..."


def at_least(least: int, why: str = "") -> Rule:
    return Rule(lambda value: value >= least, f"at least {least}{why}")


def within(interval: str, unit: str = "") -> Rule:
    """As mathematics writes it: `[0, 1)` has 0 and not 1."""
    low, high = map(float, interval[1:-1].split(","))
    above, below = (ge if interval[0] == "[" else gt), (le if interval[-1] == "]" else lt)
    return Rule(lambda value: above(value, low) and below(value, high), f"in {interval}{unit}")


def one_or_more(thing: str) -> Rule:
    return Rule(lambda values: len(values) > 0, f"a list of at least one {thing}")


ABOVE_0 = Rule(lambda value: value > 0, "above 0")

Count = Annotated[int, at_least(1)]
CountOr0 = Annotated[int, at_least(0)]
Positive = Annotated[float, ABOVE_0]
PositiveOr0 = Annotated[float, at_least(0)]
Share = Annotated[float, within("[0, 1)")]
InnerShare = Annotated[float, within("(0, 1)")]
ImagePx = Annotated[int, at_least(16, " px")]
GridRes = Annotated[int, within("[8, 512]")]  # cells along each side


def require(holds: bool, key: str, value: object, rule: str) -> None:
    """Raise BadValue unless `holds`; `key` is relative to the section."""
    if not holds:
        raise BadValue(f"{key} is {value!r}, must be {rule}")
