"""Train each method that learns from other parts, once per fold.  DVC stage `train`."""

from dataclasses import replace
from functools import partial
from pathlib import Path

from industnerf.artifacts.part import load_parts
from industnerf.artifacts.split import load_split, train_parts
from industnerf.cli import run_as_stage
from industnerf.config import StageParams
from industnerf.learning.procedural_shapes import resembled_families
from industnerf.methods import load_method
from industnerf.methods.base import Example, Input, Method, Scope
from industnerf.methods.run_method import WEIGHTS, PriorSource, fit_method, training_files
from industnerf.stage import Batch, Task, read_index, run_methods


def main(
    cfg: StageParams, parts: str, views: str, split: str, procedural: str, weights: str, out: str
) -> None:
    learning = [name for name in cfg.methods if load_method(name).scope == Scope.DATASET]
    folders = tuple(map(Path, (parts, views, split, procedural, weights)))
    batches = {
        name: Batch(training_tasks(cfg, load_method(name), *folders), Path(out) / name)
        for name in learning
    }
    limit_s = cfg.train.time_limit_s
    run_methods("train", batches, Path(out), cfg.on_failure, limit_s=limit_s)


def training_tasks(
    cfg: StageParams,
    method: Method,
    parts: Path,
    views: Path,
    split: Path,
    procedural: Path,
    weights: Path,
) -> list[Task]:
    """One task a fold."""
    settings = getattr(cfg.method, method.name)
    source, prior_keys = prior_of(method, procedural, weights)
    assignments, views_index = load_split(split), read_index(views)
    holds_out_families = cfg.split.hold_out == "family"  # of tests, so of validation too
    groups = {
        part.part_id: part.family if holds_out_families else part.part_id
        for part in load_parts(parts)
    }
    resembled = set[str]()  # families that solids may give away
    if source and holds_out_families:
        resembled = resembled_families(source.procedural, source.chunks)
    folds = {assignments[part_id].net_name for part_id in views_index}
    tasks = []
    for fold in sorted(folds):
        seen = train_parts(assignments, fold)
        held_out = sorted({groups[part] for part in assignments.keys() - set(seen)} & resembled)
        prior = replace(source, held_out=held_out) if source else None
        examples = [
            Example(part_id, groups[part_id], parts / part_id, views / part_id, method.inputs)
            for part_id in seen
            if part_id in views_index
        ]
        make = partial(fit_method, method, examples, settings=settings, seed=cfg.seed, prior=prior)
        inputs = tuple(path for example in examples for path in training_files(example))
        known_groups = [example.group for example in examples]
        key = [method.name, settings, cfg.seed, known_groups, prior_keys, held_out]
        tasks.append(Task(fold, make, key, inputs, (method.module,), resumable=True))
    return tasks


def prior_of(
    method: Method, procedural: Path, weights: Path
) -> tuple[PriorSource | None, list[str]]:
    """`fit_method`'s prior, and the keys in the store of all that it is read from."""
    if Input.PROCEDURAL_SOLIDS not in method.inputs:
        return None, []
    chunks, own = read_index(procedural), weights / method.name
    # a method that is no network has no folder of its own
    trained = read_index(own) if own.is_dir() else {}
    state = own / WEIGHTS if trained else None
    return PriorSource(state, procedural, list(chunks)), [*chunks.values(), *trained.values()]


if __name__ == "__main__":
    run_as_stage(main, "train")
