"""How far the training is, over all levels, and how soft the surface is then."""

from industnerf.methods.industnerf.levels import WARM_UP
from industnerf.schema import IndustnerfSettings, LevelSettings, WarmUpSettings


def level_of(ways: IndustnerfSettings, level: int) -> LevelSettings | WarmUpSettings:
    """The settings of a level, or of the warm-up."""
    return ways.warm_up if level == WARM_UP else ways.levels[level]


def progress(ways: IndustnerfSettings, level: int, taken: int) -> float:
    """Of the steps of all levels, the share that is done after `taken` steps of `level`."""
    levels = [ways.warm_up, *ways.levels]
    before = sum(each.steps for each in levels[: level + 1])
    return (before + taken) / sum(each.steps for each in levels)


def softness(ways: IndustnerfSettings, share: float) -> float:
    """Of the surface, in first spacings: falls geometrically from first to last step."""
    return ways.softness.first * (ways.softness.last / ways.softness.first) ** share
