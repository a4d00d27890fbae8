"""The stage that trains networks: whose parts are set apart together."""

from types import SimpleNamespace

import pytest

from industnerf.artifacts.files import write_json
from industnerf.artifacts.split import SplitAssignment, save_split
from industnerf.methods import load_method
from pipeline.stages import train
from tests.samples import unit_part

FAMILIES = {"a": "gears", "b": "gears", "c": "nuts"}


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
    assert prior == (own if weights else None, solids, ["0000", "0001"])
    assert keys == ["a", "b", *weights * ["c"]]  # in the store, which stand for all their files
    assert train.prior_of(load_method("retrieval"), solids, tmp_path) == (None, [])


@pytest.mark.parametrize("hold_out", ["family", "part", "none"])
def test_what_tests_hold_out_together_validation_does_too(hold_out, tmp_path, monkeypatch):
    tasks = []
    monkeypatch.setattr(train, "run_stage", lambda stage, made, *_, **__: tasks.extend(made))
    monkeypatch.setattr(
        train, "load_parts", lambda folder: [unit_part(*pair) for pair in FAMILIES.items()]
    )
    monkeypatch.setattr(train, "training_files", lambda example: ())
    save_split(tmp_path / "split.json", dict.fromkeys(FAMILIES, SplitAssignment("test", None)))
    write_json(
        tmp_path / "index.json", {"schema": 1, "step": "views", "keys": dict.fromkeys(FAMILIES, "")}
    )
    cfg = SimpleNamespace(
        seed=0,
        methods=["retrieval"],
        on_failure="strict",
        method=SimpleNamespace(retrieval=None),
        split=SimpleNamespace(hold_out=hold_out),
        train=SimpleNamespace(time_limit_s=1.0),
    )
    split = str(tmp_path / "split.json")
    train.main(cfg, "retrieval", "parts", str(tmp_path), split, "procedural", "weights", "out")
    (task,) = tasks
    groups = {example.part_id: example.group for example in task.make.args[1]}
    assert groups == (FAMILIES if hold_out == "family" else {name: name for name in FAMILIES})
    assert [*groups.values()] in task.settings  # or a part that changes families would not count
