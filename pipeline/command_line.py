"""What `pipeline.sweep` is told, checked before anything heavy is imported.

Hydra's own answer to a misspelled key is how to add it, and a preset that has no file it skips.
"""

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from hydra import compose, initialize_config_dir
from hydra._internal.core_plugins.basic_sweeper import BasicSweeper
from hydra._internal.utils import get_args_parser
from hydra.core.config_loader import ConfigLoader
from hydra.core.global_hydra import GlobalHydra
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import Glob, Override
from hydra.errors import HydraException
from omegaconf import DictConfig, OmegaConf, open_dict
from omegaconf.errors import OmegaConfBaseException

from hydra_plugins.optuna_sweeper import extreme_points, preset_overrides
from industnerf.config import build, flatten, read_yaml
from industnerf.errors import BadParams
from industnerf.renamed import check_overrides, flatten_preset
from industnerf.schema import Params
from industnerf.suggestions import did_you_mean

CONF_DIR = Path(__file__).parents[1] / "conf"
GROUPS = ("experiment", "reading", "ablation")  # folders of conf
SWEPT = "hydra.sweeper.params."  # below it stand keys of params.yaml, or groups


def check_command_line(arguments: Sequence[str]) -> None:
    """Raise BadParams for a key, a group or a choice that there is not, and say what may be meant.

    Values are checked where their types are: `check_values`.
    """
    options = get_args_parser().parse_args(arguments)
    if is_question(options):
        return
    if options.multirun and options.cfg:
        raise BadParams("--cfg prints the values of one point: leave --multirun out")
    _check_renamed(options.overrides)
    with _config_loader() as loader:
        overrides = [_parse(text) for text in options.overrides]
        for override in overrides:
            if _is_group(override):
                _check_choices(override, loader)
        engines = [text for text in options.overrides if text.startswith("hydra/")]
        keys = _known_keys(compose("config", engines, return_hydra_config=True))
        is_basic = not any(text.startswith("hydra/sweeper=") for text in engines)
        for override in overrides:
            if is_basic and override.is_interval_sweep():
                raise BadParams(f"{override.input_line} needs hydra/sweeper=optuna")
            if not _is_group(override):
                _check_key(override, keys)


def is_question(options: argparse.Namespace) -> bool:
    """Whether Hydra is only to answer something: nothing is run then, and nothing checked."""
    return any((options.help, options.hydra_help, options.shell_completion, options.info))


def check_choice(group: str, choice: str | None, available: Sequence[str]) -> None:
    """Raise BadParams if `choice` is none of the files of `group`."""
    if choice in (None, "null", *available):
        return
    advice = did_you_mean(str(choice), available)
    raise BadParams(f"{group}={choice} is unknown{advice or ','} known are {', '.join(available)}")


def check_values(config: DictConfig, choices: Mapping[str, str | None]) -> Params:
    """The composed configuration as parameters.

    Raises BadParams if a value is not as params.yaml must be, or a group's choice has no file:
    Hydra skips what is optional and missing.
    """
    for group in GROUPS:
        check_choice(group, choices.get(group), group_files(group))
    return build(Params, OmegaConf.to_container(config, resolve=True), "the composed configuration")


def check_points(config: DictConfig, points: Sequence[Sequence[str]]) -> list[Params]:
    """The parameters of those of the `points` of a sweep, as overrides, that have any.

    Says of the others what is wrong.  Raises BadParams if no point is left.
    """
    valid, loader = [], GlobalHydra.instance().config_loader()
    for overrides in points:
        try:
            point = loader.load_sweep_config(config, list(overrides))
            with open_dict(point):
                choices = point.pop("hydra").runtime.choices
            valid.append(check_values(point, choices))
        except (HydraException, OmegaConfBaseException, BadParams) as error:
            reason = f"{' '.join(overrides)}: {' '.join(str(error).split())}"
            if len(points) == 1:
                raise BadParams(reason) from None
            print(f"error at {reason}", file=sys.stderr)
    if not valid:
        raise BadParams(f"none of the {len(points)} points can be run")
    return valid


def tuning_ends(config: DictConfig) -> list[list[str]]:
    """The overrides of two points of a tuning: every tuned key at either end of its range."""
    preset = preset_overrides(config.hydra.sweeper.params)
    return extreme_points([*preset, *config.hydra.overrides.task])


def grid_points(config: DictConfig) -> list[list[str]]:
    """The overrides of every point of a sweep over a grid, which Hydra's own sweeper runs."""
    preset = preset_overrides(config.hydra.sweeper.params)
    loader = GlobalHydra.instance().config_loader()
    parser = OverridesParser.create(loader)
    overrides = parser.parse_overrides([*preset, *config.hydra.overrides.task])
    (points,) = BasicSweeper.split_arguments(overrides, max_batch_size=None)
    return points


def group_files(group: str) -> list[str]:
    """The choices of a group of conf/, by name."""
    return sorted(path.stem for path in (CONF_DIR / group).glob("*.yaml"))


def _check_renamed(overrides: Sequence[str]) -> None:
    """Raise BadParams if a key, a file or a preset of the command line has another name now."""
    pairs = [override.lstrip("+~").partition("=")[::2] for override in overrides]
    check_overrides(pairs)
    presets = [name for key, value in pairs if key == "experiment" for name in value.split(",")]
    for name in presets:
        if (path := CONF_DIR / "experiment" / f"{name}.yaml").exists():
            check_overrides(flatten_preset(read_yaml(path)))


@contextmanager
def _config_loader() -> Iterator[ConfigLoader]:
    with initialize_config_dir(str(CONF_DIR), version_base="1.3"):
        yield GlobalHydra.instance().config_loader()


def _parse(text: str) -> Override:
    try:
        return OverridesParser.create().parse_override(text)
    except HydraException as error:
        reason = " ".join(str(error).split())
        raise BadParams(
            f"{text!r} is no override, which is key=value, as in views.count=8 or "
            f"'methods=[hull,carve]': {reason}"
        ) from None


def _is_group(override: Override) -> bool:
    return override.key_or_group in GROUPS or "/" in override.key_or_group


def _check_choices(override: Override, loader: ConfigLoader) -> None:
    group = override.key_or_group
    available = group_files(group) if group in GROUPS else loader.get_group_options(group)
    if not available:
        parent = group.rpartition("/")[0]
        siblings = [f"{parent}/{name}" for name in loader.list_groups(parent)]
        raise BadParams(f"{group} is no group{did_you_mean(group, siblings)}")
    for choice in _values(override):
        check_choice(group, choice, available)


def _values(override: Override) -> list[str | None]:
    """What is chosen, of a sweep all of it; what a glob matches has files."""
    value = override.value()
    if not override.is_sweep_override():
        return [None if value is None else str(value)]
    return [] if isinstance(value, Glob) else list(override.sweep_string_iterator())


def _known_keys(config: Any) -> dict[str, bool]:
    """Every dotted key of `config`, and whether it is a section."""
    values = OmegaConf.to_container(config, resolve=False)
    leaves = flatten(values)
    sections = {
        ".".join(names[:count])
        for names in (leaf.split(".") for leaf in leaves)
        for count in range(1, len(names))
    }
    return dict.fromkeys(leaves, False) | dict.fromkeys(sections, True)


def _check_key(override: Override, keys: dict[str, bool]) -> None:
    key = override.key_or_group.removeprefix(SWEPT)
    if key in GROUPS or (key.startswith("hydra.") and override.is_add()):
        return
    if key not in keys:
        advice = did_you_mean(key, [*keys, *GROUPS]) or "; params.yaml has all that there are"
        raise BadParams(f"there is no key {key}{advice}")
    is_section_value = override.is_delete() or isinstance(override.value(), dict)
    if keys[key] and not is_section_value and not override.is_sweep_override():
        top_level = [known for known in keys if "." not in known and known != key]
        names = [known.removeprefix(f"{key}.") for known in keys if known.startswith(f"{key}.")]
        advice = did_you_mean(key, top_level) or f" with the keys {', '.join(names)}"
        raise BadParams(f"{key} is a section{advice}")
