"""How far the training is, over all levels, and how soft the surface is then."""

from industnerf.methods.industnerf.point_levels import WARM_UP
from industnerf.schema import IndustnerfSettings, LevelSettings, WarmUpSettings


def level_settings(settings: IndustnerfSettings, level: int) -> LevelSettings | WarmUpSettings:
    """The settings of a level, or of the warm-up."""
    return settings.warm_up if level == WARM_UP else settings.levels[level]


def training_progress(settings: IndustnerfSettings, level: int, steps_done: int) -> float:
    """Of the steps of all levels, the share that is done after `taken` steps of `level`."""
    levels = [settings.warm_up, *settings.levels]
    previous_steps = sum(each.steps for each in levels[: level + 1])
    return (previous_steps + steps_done) / sum(each.steps for each in levels)


def beta_at(settings: IndustnerfSettings, progress: float) -> float:
    """Of the surface, in first spacings: falls geometrically from first to last step."""
    return settings.beta.start * (settings.beta.end / settings.beta.start) ** progress
