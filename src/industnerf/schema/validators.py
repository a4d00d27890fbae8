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
    is_valid: Callable[[Any], bool]
    message: str  # "must be ..."
    choices: tuple[str, ...] = ()  # all that are valid, where they can be counted


def at_least(minimum: int, suffix: str = "") -> Rule:
    return Rule(lambda value: value >= minimum, f"at least {minimum}{suffix}")


def in_interval(interval: str, unit: str = "") -> Rule:
    """As mathematics writes it: `[0, 1)` has 0 and not 1."""
    low, high = map(float, interval[1:-1].split(","))
    above, below = (ge if interval[0] == "[" else gt), (le if interval[-1] == "]" else lt)
    return Rule(lambda value: above(value, low) and below(value, high), f"in {interval}{unit}")


def one_of(choices: tuple[str, ...]) -> Rule:
    return Rule(lambda value: value in choices, f"one of {', '.join(choices)}", choices)


def non_empty(thing: str) -> Rule:
    return Rule(lambda values: len(values) > 0, f"a list of at least one {thing}")


POSITIVE = Rule(lambda value: value > 0, "above 0")

PositiveInt = Annotated[int, at_least(1)]
NonNegativeInt = Annotated[int, at_least(0)]
PositiveFloat = Annotated[float, POSITIVE]
NonNegativeFloat = Annotated[float, at_least(0)]
Fraction = Annotated[float, in_interval("[0, 1)")]
OpenFraction = Annotated[float, in_interval("(0, 1)")]
ImagePx = Annotated[int, at_least(16, " px")]
GridRes = Annotated[int, in_interval("[8, 512]")]  # cells along each side


def require(condition: bool, key: str, value: object, rule: str) -> None:
    """Raise BadValue unless `condition` holds; `key` is relative to the section."""
    if not condition:
        raise BadValue(f"{key} is {value!r}, must be {rule}")
