"""Hydra's `hydra/sweeper=optuna`: a trial of Optuna is a point of the sweep.

interval(0, 1)  a number, tag(log, interval(1e-4, 1)) on a logarithmic scale, int(interval(1, 8)) a
whole one; range(8, 41, 8); a,b,c or choice(a, b, c) one of these.  A job returns what is tuned.

It stands in `hydra_plugins` because Hydra takes plugins from nowhere else, and it imports Optuna
only when it runs because Hydra loads all plugins at every start.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import (
    ChoiceSweep,
    IntervalSweep,
    Override,
    RangeSweep,
    Transformer,
)
from hydra.core.plugins import Plugins
from hydra.plugins.sweeper import Sweeper
from hydra.types import HydraContext, TaskFunction
from omegaconf import DictConfig, OmegaConf

RESULTS = "optimization_results.yaml"  # in the folder of the sweep, as hydra-optuna-sweeper has it


class OptunaSweeper(Sweeper):
    """Asks Optuna for trials, has them run, and tells it what they returned."""

    def __init__(
        self,
        n_trials: int,
        n_jobs: int,
        direction: str,
        storage: str | None,
        study_name: str | None,
        sampler: Any,  # made by Hydra from its `_target_`
        params: DictConfig,
    ) -> None:
        self.n_trials, self.n_jobs, self.direction = n_trials, n_jobs, direction
        self.storage, self.study_name, self.sampler = storage, study_name, sampler
        self.params = params

    def setup(
        self, *, hydra_context: HydraContext, task_function: TaskFunction, config: DictConfig
    ) -> None:
        self.hydra_context, self.config = hydra_context, config
        self.launcher = Plugins.instance().instantiate_launcher(
            hydra_context=hydra_context, task_function=task_function, config=config
        )

    def sweep(self, arguments: list[str]) -> None:
        import optuna

        folder = Path(self.config.hydra.sweep.dir)
        folder.mkdir(parents=True, exist_ok=True)
        OmegaConf.save(self.config, folder / "multirun.yaml")
        fixed, swept = split_overrides([*preset_overrides(self.params), *arguments])
        distributions = {key: distribution(override) for key, override in swept.items()}
        optuna.logging.set_verbosity(optuna.logging.WARNING)
        study = optuna.create_study(
            storage=self.storage,
            sampler=self.sampler,
            study_name=self.study_name,
            direction=self.direction,
            load_if_exists=True,
        )
        for first in range(0, self.n_trials, self.n_jobs):
            count = min(self.n_jobs, self.n_trials - first)
            trials = [study.ask(distributions) for _ in range(count)]
            points = [[*fixed, *as_overrides(trial.params)] for trial in trials]
            self.validate_batch_is_legal(points)
            for trial, job in zip(trials, self.launcher.launch(points, first), strict=True):
                value = job.return_value
                failed = optuna.trial.TrialState.FAIL if value is None else None
                study.tell(trial, value, failed)
                print(_progress(trial, value, study, self.n_trials), flush=True)
        if any(trial.value is not None for trial in study.trials):
            best = {"best_params": study.best_params, "best_value": study.best_value}
            OmegaConf.save({"name": "optuna", **best}, folder / RESULTS)
            print(f"best: {' '.join(as_overrides(study.best_params))}; {folder / RESULTS}")


def preset_overrides(params: DictConfig | None) -> list[str]:
    """What a file says is swept, as on a command line."""
    return [f"{key}={value}" for key, value in (params or {}).items()]


def split_overrides(texts: Sequence[str]) -> tuple[list[str], dict[str, Override]]:
    """The overrides that are the same in all trials, and by key those that are tuned."""
    overrides = {o.get_key_element(): o for o in OverridesParser.create().parse_overrides([*texts])}
    fixed = [
        f"{key}={override.get_value_element_as_str()}"
        for key, override in overrides.items()
        if not override.is_sweep_override()
    ]
    return fixed, {key: o for key, o in overrides.items() if o.is_sweep_override()}


def distribution(override: Override) -> Any:
    """Optuna's distribution of what `override` sweeps."""
    from optuna.distributions import CategoricalDistribution, FloatDistribution, IntDistribution

    value = override.value()
    is_log = "log" in getattr(value, "tags", ())
    match value:
        case IntervalSweep() if isinstance(value.start, int):
            return IntDistribution(value.start, value.end, log=is_log)
        case IntervalSweep():
            return FloatDistribution(value.start, value.end, log=is_log)
        case RangeSweep() if all(isinstance(v, int) for v in (value.start, value.stop, value.step)):
            return IntDistribution(value.start, value.stop - 1, step=value.step)
        case ChoiceSweep() | RangeSweep():
            choices = override.sweep_iterator(transformer=Transformer.encode)
            return CategoricalDistribution([str(choice) for choice in choices])
    raise TypeError(f"{override.input_line} cannot be tuned")


def extreme_points(texts: Sequence[str]) -> list[list[str]]:
    """The overrides of two trials, all keys at their first value and all at their last."""
    fixed, swept = split_overrides(texts)
    ends = {key: _ends(override) for key, override in swept.items()}
    return [[*fixed, *as_overrides({key: ends[key][i] for key in ends})] for i in (0, 1)]


def _ends(override: Override) -> tuple[Any, Any]:
    value = override.value()
    if isinstance(value, IntervalSweep):
        return value.start, value.end
    choices = list(override.sweep_string_iterator())
    return choices[0], choices[-1]


def as_overrides(params: dict[str, Any]) -> list[str]:
    return [f"{key}={value}" for key, value in params.items()]


def _progress(trial: Any, value: float | None, study: Any, count: int) -> str:
    outcome = "failed" if value is None else f"{value:.4f}"
    values = [done.value for done in study.trials if done.value is not None]
    best = f", best {study.best_value:.4f} in trial {study.best_trial.number}" if values else ""
    return (
        f"trial {trial.number} of {count}: {' '.join(as_overrides(trial.params))}: {outcome}{best}"
    )
