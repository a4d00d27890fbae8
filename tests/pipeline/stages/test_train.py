"""The stage that trains networks: whose parts are set apart together."""

from types import SimpleNamespace

import pytest

from industnerf.artifacts.files import write_json
from industnerf.artifacts.split import SplitAssignment, save_split
from industnerf.methods import load_method
from industnerf.methods.run_method import PriorSource
from pipeline.stages import train
from tests.learning.test_procedural_shapes import arrays
from tests.samples import unit_part

FAMILIES = {"a": "gears", "b": "gears", "c": "nuts"}
SOLIDS = [None, "gears", "nuts"]  # what each of them resembles


@pytest.mark.parametrize(
    ("name", "weights"), [("retrieval_procedural", False), ("r2n2", True), ("occupancy", False)]
)
def test_solids_are_learned_from_with_weights_or_without(name, weights, tmp_path):
    """A method that is no network has no folder of weights; of one without them it is empty."""
    for folder, keys in (
        ("solids", {"0000": "a", "0001": "b"}),
        ("weights/r2n2", {"weights": "c"}),
        ("weights/occupancy", {}),
    ):
        (tmp_path / folder).mkdir(parents=True)
        record = {"schema": 1, "step": "made", "keys": keys}
        write_json(tmp_path / folder / "index.json", record)
    solids, own = tmp_path / "solids", tmp_path / "weights" / name / "weights"
    prior, keys = train.prior_of(load_method(name), solids, tmp_path / "weights")
    assert prior == PriorSource(own if weights else None, solids, ["0000", "0001"])
    assert keys == ["a", "b", *weights * ["c"]]  # in the store, which stand for all their files
    assert train.prior_of(load_method("retrieval"), solids, tmp_path) == (None, [])


@pytest.fixture
def tasks_of(tmp_path, monkeypatch):
    """`tasks_of(method, hold_out, folds)`: what the stage would do, by the name of the network."""
    tasks = []

    def run_methods(stage, batches, *_, **__):
        tasks.extend(task for batch in batches.values() for task in batch.tasks)

    monkeypatch.setattr(train, "run_methods", run_methods)
    monkeypatch.setattr(
        train, "load_parts", lambda folder: [unit_part(*pair) for pair in FAMILIES.items()]
    )
    monkeypatch.setattr(train, "training_files", lambda example: ())

    def tasks_of(method, hold_out, folds):
        split = {part: SplitAssignment("test", fold) for part, fold in folds.items()}
        save_split(tmp_path / "split.json", split)
        index = {"schema": 1, "step": "views", "keys": dict.fromkeys(FAMILIES, "")}
        write_json(tmp_path / "index.json", index)
        cfg = SimpleNamespace(
            seed=0,
            methods=[method],
            on_failure="strict",
            method=SimpleNamespace(**{method: None}),
            split=SimpleNamespace(hold_out=hold_out),
            train=SimpleNamespace(time_limit_s=1.0),
        )
        paths = ("parts", tmp_path, tmp_path / "split.json", tmp_path / "solids", "weights", "out")
        tasks.clear()
        train.main(cfg, *map(str, paths))
        return {task.part_id: task for task in tasks}

    return tasks_of


@pytest.mark.parametrize("hold_out", ["family", "part", "none"])
def test_what_tests_hold_out_together_validation_does_too(hold_out, tasks_of):
    (task,) = tasks_of("retrieval", hold_out, dict.fromkeys(FAMILIES)).values()
    groups = {example.part_id: example.group for example in task.make.args[1]}
    assert groups == (FAMILIES if hold_out == "family" else {name: name for name in FAMILIES})


@pytest.mark.parametrize(
    ("hold_out", "folds", "seen"),
    [
        ("family", {"a": 0, "b": 0, "c": 1}, {"fold-0": [None, "nuts"], "fold-1": [None, "gears"]}),
        ("part", {"a": 0, "b": 1, "c": 1}, dict.fromkeys(["fold-0", "fold-1"], SOLIDS)),
        ("none", dict.fromkeys(FAMILIES), {"all": SOLIDS}),
    ],
)
def test_solids_that_resemble_a_family_are_held_out_with_it(
    hold_out, folds, seen, tasks_of, tmp_path
):
    folder = tmp_path / "solids"
    (folder / "0000").mkdir(parents=True)
    arrays(len(SOLIDS)).save(folder / "0000", ["kind"] * len(SOLIDS), SOLIDS)
    write_json(folder / "index.json", {"schema": 1, "step": "made", "keys": {"0000": "key"}})
    tasks = tasks_of("retrieval_procedural", hold_out, folds)
    loaded = {
        net: [solid.resembles for solid in task.make.keywords["prior"].load().solids]
        for net, task in tasks.items()
    }
    assert loaded == seen
    assert len({str(task.settings[-1]) for task in tasks.values()}) == len(
        {str(solids) for solids in seen.values()}
    )  # the store tells them apart
