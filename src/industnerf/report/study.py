"""All inputs of the report, read once from the folders of the stages."""

from collections import Counter
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from industnerf.artifacts.cloud import EXTRA_CLOUDS, Cloud, load_warnings
from industnerf.artifacts.files import read_npz
from industnerf.artifacts.part import Part, load_parts
from industnerf.artifacts.part_warnings import load_part_warnings
from industnerf.artifacts.scores import PartScore, load_method_scores
from industnerf.artifacts.split import SplitAssignment, load_split
from industnerf.artifacts.state import ModelState
from industnerf.artifacts.truth import Truth
from industnerf.artifacts.views import load_views
from industnerf.methods import load_method
from industnerf.methods.base import Input, Method, Scope
from industnerf.stage import read_failures, read_index

IMAGE_INPUTS = {Input.RGB, Input.MASK, Input.DEPTH}
# Setting that limits the views of a method: the most views of one prediction, or (eval_views) the
# most predictions, each from one view.
LIMITED_BY = {
    "r2n2": "max_views",
    "retrieval": "views",
    "retrieval_procedural": "views",
    "atlasnet": "eval_views",
    "occupancy": "eval_views",
}


@dataclass(frozen=True)
class StudyFolders:
    """Output folders of the stages before the report."""

    solids: Path
    parts: Path
    views: Path
    split: Path
    truth: Path
    procedural: Path
    states: Path
    clouds: Path
    scores: Path

    @classmethod
    def all_at(cls, folder: Path) -> "StudyFolders":
        """One folder in place of all: of published results none of them is there."""
        return cls(*[folder] * len(fields(cls)))


@dataclass(frozen=True)
class TrainingSummary:
    """Training of a method on other parts."""

    model_size: str  # preset of its network; empty where it has none
    num_train_parts: int  # the fewest of any fold
    hold_out: str  # see split.hold_out
    has_converged: bool  # the validation loss of every fold had stopped falling


@dataclass(frozen=True)
class InputViews:
    """A score is the mean over `num_predictions`, each from `views_per_prediction` views."""

    views_per_prediction: int  # 0: no image of the part
    num_predictions: int = 1


@dataclass(frozen=True, kw_only=True)
class Study:
    """One run of the pipeline; dicts are by method or part id."""

    preset: str
    seed: int
    num_train_views: int  # per part
    methods: dict[str, Method]
    parts: dict[str, Part]
    assignments: dict[str, SplitAssignment]
    scores: list[PartScore]
    failures: dict[str, dict[str, str]]  # stage or method -> part id -> reason
    input_warnings: dict[str, dict[str, list[str]]]  # stage or method -> part id -> messages
    parameters_and_steps: dict[str, tuple[int, int]]  # learned, of the largest part or network
    training_summaries: dict[str, TrainingSummary]  # of methods that learn from other parts
    train_visible_share: dict[str, float]  # of the surface, in the training views
    rig_visible_share: dict[str, float]  # of the surface, from the reference rig
    folders: StudyFolders
    input_views: dict[str, InputViews]
    seeds_sd: dict[str, float]  # standard deviation of the mean EMD over seeds, where known
    empty_predictions: dict[tuple[str, str], int]  # by method and split, if there are several


@dataclass(frozen=True)
class RunMetadata:
    """The parameters of a study that the report shows."""

    preset: str
    seed: int
    num_train_views: int
    hold_out: str
    methods: list[str]
    method_settings: Any  # attribute per method


def load_study(folders: StudyFolders, metadata: RunMetadata) -> Study:
    """Read all artifacts; raises BadArtifact that names the first one missing or torn."""
    methods = metadata.methods
    loaded = {name: load_method(name) for name in methods}
    view_index, assignments = read_index(folders.views), load_split(folders.split)
    return Study(
        preset=metadata.preset,
        seed=metadata.seed,
        num_train_views=metadata.num_train_views,
        methods=loaded,
        parts={part.part_id: part for part in load_parts(folders.parts)},
        assignments=assignments,
        scores=[row for name in methods for row in load_method_scores(folders.scores / name, name)],
        failures=failures_of(folders, methods),
        input_warnings={
            "parts": load_part_warnings(folders.parts, "parts"),
            "views": load_part_warnings(folders.views, "views"),
        }
        | {name: _load_input_warnings(folders.clouds / name) for name in methods},
        parameters_and_steps={
            name: _parameters_and_steps(folders.clouds / name) for name in methods
        },
        training_summaries={
            name: summary
            for name, method in loaded.items()
            if method.scope == Scope.DATASET
            and (summary := _training_summary(folders.states / name, metadata.hold_out)) is not None
        },
        train_visible_share={
            name: load_views(folders.views / name).train_visible_share for name in view_index
        },
        rig_visible_share={
            name: Truth.load(folders.truth / name).visible_share
            for name in read_index(folders.truth)
        },
        folders=folders,
        input_views={
            name: input_views_of(loaded[name], metadata.num_train_views, metadata.method_settings)
            for name in methods
        },
        seeds_sd={},
        empty_predictions=_count_empty_predictions(folders.clouds, methods, assignments),
    )


def failures_of(folders: StudyFolders, methods: list[str]) -> dict[str, dict[str, str]]:
    """Failures of every stage from a part to its cloud, each listed once, where it happened."""
    parts, views = read_failures(folders.parts), read_failures(folders.views)
    failures = {"parts": parts, "views": _without(views, parts)}
    failures["truth"] = _without(read_failures(folders.truth), parts)
    for name in methods:
        failures[name] = _without(read_failures(folders.clouds / name), views)
    return failures


def _without(failures: dict[str, str], earlier: dict[str, str]) -> dict[str, str]:
    """`failures` without those of the stage before."""
    return {part: reason for part, reason in failures.items() if part not in earlier}


def _load_input_warnings(clouds: Path) -> dict[str, list[str]]:
    warnings_by_part = {part: load_warnings(clouds / part) for part in read_index(clouds)}
    return {part: messages for part, messages in warnings_by_part.items() if messages}


def _parameters_and_steps(clouds: Path) -> tuple[int, int]:
    """Learned parameters and steps of the part or fold with the most steps."""
    sizes = [Cloud.load_training_stats(clouds / part) for part in read_index(clouds)]
    return max(sizes, key=lambda size: size[::-1], default=(0, 0))


def _count_empty_predictions(
    clouds: Path, methods: list[str], assignments: dict[str, SplitAssignment]
) -> dict[tuple[str, str], int]:
    """Predictions without a point, by method and split, over the parts that did not fail."""
    counts = Counter[tuple[str, str]]()
    for name in methods:
        for part in read_index(clouds / name):
            if (path := clouds / name / part / EXTRA_CLOUDS).exists():
                (ends,) = read_npz(path, ("ends",), "reconstruct")
                empty = np.count_nonzero(np.diff(ends, prepend=0) == 0)
                counts[name, assignments[part].split] += int(empty)
    return dict(counts)


def _training_summary(states: Path, hold_out: str) -> TrainingSummary | None:
    """None if the method does not learn from other parts."""
    summaries = [ModelState.summary(states / net) for net in read_index(states)]
    if not summaries:
        return None
    num_train_parts = min(summary["num_parts"] for summary in summaries)
    has_converged = all(summary["converged"] for summary in summaries)
    return TrainingSummary(summaries[0]["size"], num_train_parts, hold_out, has_converged)


def input_views_of(method: Method, num_views: int, settings: Any) -> InputViews:
    """What `method` is given of `num_views` views; `settings` has an attribute per method."""
    if not IMAGE_INPUTS & method.inputs:
        return InputViews(0)
    if method.name not in LIMITED_BY:
        return InputViews(num_views)
    setting = LIMITED_BY[method.name]
    limit = min(num_views, getattr(getattr(settings, method.name), setting))
    return InputViews(1, limit) if setting == "eval_views" else InputViews(limit)
