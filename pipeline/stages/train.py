"""Train a method that learns from other parts, once per fold.  DVC stage `train`."""

from dataclasses import replace
from functools import partial
from pathlib import Path

from industnerf.artifacts.part import load_parts
from industnerf.artifacts.split import load_split, train_parts
from industnerf.cli import run_as_stage
from industnerf.config import StageParams
from industnerf.learning.procedural_shapes import resembled_families
from industnerf.methods import load_method
from industnerf.methods.base import Example, Input, Method
from industnerf.methods.run_method import WEIGHTS, PriorSource, fit_method, training_files
from industnerf.stage import Task, read_index, run_stage


def main(
    cfg: StageParams,
    name: str,
    parts: str,
    views: str,
    split: str,
    procedural: str,
    weights: str,
    out: str,
) -> None:
    method, settings = load_method(name), getattr(cfg.method, name)
    source, prior_keys = prior_of(method, Path(procedural), Path(weights))
    assignments, views_index = load_split(Path(split)), read_index(Path(views))
    holds_out_families = cfg.split.hold_out == "family"  # of tests, so of validation too
    groups = {
        part.part_id: part.family if holds_out_families else part.part_id
        for part in load_parts(Path(parts))
    }
    resembled = set[str]()  # families that solids may give away
    if source and holds_out_families:
        resembled = resembled_families(source.procedural, source.chunks)
    folds = {assignments[part_id].net_name for part_id in views_index}
    tasks = []
    for fold in sorted(folds) if name in cfg.methods else []:
        seen = train_parts(assignments, fold)
        held_out = sorted({groups[part] for part in assignments.keys() - set(seen)} & resembled)
        prior = replace(source, held_out=held_out) if source else None
        examples = [
            Example(
                part_id,
                groups[part_id],
                Path(parts) / part_id,
                Path(views) / part_id,
                method.inputs,
            )
            for part_id in seen
            if part_id in views_index
        ]
        make = partial(fit_method, method, examples, settings=settings, seed=cfg.seed, prior=prior)
        inputs = tuple(path for example in examples for path in training_files(example))
        known_groups = [example.group for example in examples]
        key = [name, settings, cfg.seed, known_groups, prior_keys, held_out]
        tasks.append(Task(fold, make, key, inputs, (method.module,), resumable=True))
    limits = {"limit_s": cfg.train.time_limit_s, "needs_one": False}
    run_stage("train", tasks, Path(out), cfg.on_failure, **limits)


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
