"""Everything the report is made of, read once."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from industnerf.artifacts.cloud import OTHERS, Cloud, load_remarks
from industnerf.artifacts.files import read_npz
from industnerf.artifacts.part import Part, load_parts
from industnerf.artifacts.scores import PartScore, load_method_scores
from industnerf.artifacts.split import Place, load_split
from industnerf.artifacts.state import State
from industnerf.artifacts.truth import Truth
from industnerf.artifacts.views import load_views
from industnerf.methods import load_method
from industnerf.methods.base import Method
from industnerf.report.given import Views, views_of
from industnerf.stage import read_failures, read_index


@dataclass(frozen=True)
class Folders:
    """Where the stages before the report wrote."""

    solids: Path
    parts: Path
    views: Path
    split: Path
    truth: Path
    states: Path
    clouds: Path
    scores: Path


@dataclass(frozen=True)
class Lesson:
    """How a method learned from other parts."""

    size: str  # of its net; empty where it has none
    parts: int  # the fewest that any of its nets learned from
    hold_out: str  # see split.hold_out
    settled: bool  # every net's validation loss had stopped falling


@dataclass(frozen=True, kw_only=True)
class Study:
    """One run of the pipeline."""

    preset: str
    seed: int
    views: int  # training views a part
    methods: dict[str, Method]
    parts: dict[str, Part]
    places: dict[str, Place]
    scores: list[PartScore]
    failures: dict[str, dict[str, str]]  # stage, method or its scoring -> part id -> why
    remarks: dict[str, dict[str, list[str]]]  # method -> part id -> what it said of its images
    training: dict[str, tuple[int, int]]  # method -> trained numbers, most steps a part or net
    lessons: dict[str, Lesson]  # method that learns from other parts -> what of
    seen_by_training: dict[str, float]  # part id -> share of its area
    seen_by_rig: dict[str, float]  # the same, of what counts
    folders: Folders
    given: dict[str, Views]  # method -> what it was given of those views
    seeds_sd: dict[str, float]  # method -> how far its mean EMD moves with the seed, where known
    empty_answers: dict[tuple[str, str], int]  # by method and split, where several are given


@dataclass(frozen=True)
class About:
    """What parameters say of a study."""

    preset: str
    seed: int
    views: int
    hold_out: str
    methods: list[str]
    settings: Any  # of methods, by their names


def gather(folders: Folders, about: About) -> Study:
    """Read every artefact; raises BadArtifact that names the first one missing or torn."""
    methods = about.methods
    known = {name: load_method(name) for name in methods}
    photographed, places = read_index(folders.views), load_split(folders.split)
    return Study(
        preset=about.preset,
        seed=about.seed,
        views=about.views,
        methods=known,
        parts={part.part_id: part for part in load_parts(folders.parts)},
        places=places,
        scores=[row for name in methods for row in load_method_scores(folders.scores / name, name)],
        failures=failures_of(folders, methods),
        remarks={name: _remarks(folders.clouds / name) for name in methods},
        training={name: _training(folders.clouds / name) for name in methods},
        lessons={
            name: lesson
            for name in methods
            if (lesson := _lesson(folders.states / name, about.hold_out)) is not None
        },
        seen_by_training={
            name: load_views(folders.views / name).seen_by_training for name in photographed
        },
        seen_by_rig={
            name: Truth.load(folders.truth / name).visible_share
            for name in read_index(folders.truth)
        },
        folders=folders,
        given={name: views_of(known[name], about.views, about.settings) for name in methods},
        seeds_sd={},
        empty_answers=_empty_answers(folders.clouds, methods, places),
    )


def failures_of(folders: Folders, methods: list[str]) -> dict[str, dict[str, str]]:
    """Of each stage on the way from a part to its score; a stage hands on those before it."""
    parts, views = read_failures(folders.parts), read_failures(folders.views)
    found = {"parts": parts, "views": _less(views, parts)}
    found["truth"] = _less(read_failures(folders.truth), parts)
    for name in methods:
        found[name] = _less(read_failures(folders.clouds / name), views)
        found[f"scoring {name}"] = read_failures(folders.scores / name)
    return found


def _less(failures: dict[str, str], before: dict[str, str]) -> dict[str, str]:
    """`failures` without those that the stage before handed on."""
    return {part: why for part, why in failures.items() if part not in before}


def _remarks(clouds: Path) -> dict[str, list[str]]:
    said = {part: load_remarks(clouds / part) for part in read_index(clouds)}
    return {part: remarks for part, remarks in said.items() if remarks}


def _training(clouds: Path) -> tuple[int, int]:
    """The most that any part, or any of several nets, took."""
    made = [Cloud.training(clouds / part) for part in read_index(clouds)]
    return max(made, key=lambda one: one[::-1], default=(0, 0))


def _empty_answers(
    clouds: Path, methods: list[str], places: dict[str, Place]
) -> dict[tuple[str, str], int]:
    """Answers without a point, over the parts of each split that did not fail."""
    found = Counter[tuple[str, str]]()
    for name in methods:
        for part in read_index(clouds / name):
            if (path := clouds / name / part / OTHERS).exists():
                (ends,) = read_npz(path, ("ends",), "reconstruct")
                empty = np.count_nonzero(np.diff(ends, prepend=0) == 0)
                found[name, places[part].split] += int(empty)
    return dict(found)


def _lesson(states: Path, hold_out: str) -> Lesson | None:
    """None if the method learned from no other part."""
    found = [State.summary(states / net) for net in read_index(states)]
    if not found:
        return None
    fewest, settled = min(one["parts"] for one in found), all(one["settled"] for one in found)
    return Lesson(found[0]["size"], fewest, hold_out, settled)
