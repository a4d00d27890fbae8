"""What networks start from: procedural solids, pretrained weights, and how these reach them."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from industnerf.artifacts.state import ModelState
from industnerf.errors import BadParams
from industnerf.learning.procedural_shapes import load_procedural_shapes
from industnerf.methods import load_method, run_method
from industnerf.schema import PretrainParams, ProceduralParams
from industnerf.stage import read_index
from pipeline.stages import pretrain, procedural, train
from tests.methods.test_conformance import merged

SMOKE = merged("params.yaml", "conf/experiment/smoke.yaml")


def config(solids=3, weights="trained", methods=("r2n2",), kinds="abstract"):
    """Two steps of the smallest network on solids of 32 px."""
    few = replace(SMOKE.method.r2n2.pretraining, max_steps=2, val_interval=1, batch_size=2)
    r2n2 = replace(SMOKE.method.r2n2, channel_divisor=32, pretraining=few)
    return SimpleNamespace(
        seed=5,
        methods=list(methods),
        method=SimpleNamespace(r2n2=r2n2, retrieval=SMOKE.method.retrieval),
        views=replace(SMOKE.views, count=4),
        procedural=ProceduralParams(solids=solids, kinds=kinds, views=2, image_px=32),
        pretrain=PretrainParams(weights=weights, time_limit_s=600.0),
    )


@pytest.fixture
def run(tmp_path, monkeypatch):
    """`run(cfg)`: the folder of the solids, and that of the weights of all methods."""
    monkeypatch.setenv("INDUSTNERF_STORE", str(tmp_path / "store"))
    monkeypatch.setenv("INDUSTNERF_RUNNER", "serial")

    def run(cfg, shipped="nothing"):
        solids, weights = tmp_path / "procedural", tmp_path / "weights"
        procedural.main(cfg, str(solids))
        pretrain.main(cfg, str(tmp_path / shipped), str(solids), str(weights))
        return solids, weights

    return run


def prior_of(name, solids, weights):
    prior, keys = train.prior_of(load_method(name), solids, weights)
    own = read_index(weights / name) if (weights / name).is_dir() else {}
    assert keys == [*read_index(solids).values(), *own.values()]
    return None if prior is None else prior.load()


def test_trained_weights_reach_the_training_with_the_solids_that_made_them(run):
    solids, weights = run(config())
    prior = prior_of("r2n2", solids, weights)
    assert len(prior.solids) == 3
    assert prior.solids[0].rgb(32, 9).shape == (2, 32, 32, 3)
    assert (prior.weights.steps, prior.weights.num_parts) == (2, 2)  # one is validated on
    assert prior.weights.val_history.steps.tolist() == [0, 1]


def test_a_pretraining_leaves_out_solids_that_resemble_a_family(run):
    """All folds start from its weights, whatever they hold out."""
    solids, weights = run(config(solids=16, kinds="all"))
    shapes = load_procedural_shapes(solids, list(read_index(solids)))
    abstract = sum(shape.resembles is None for shape in shapes)
    assert abstract < len(shapes)
    assert ModelState.load(weights / "r2n2" / "weights").num_parts == abstract - 1  # to validate on


def test_a_pretraining_without_an_abstract_solid_names_the_knob(tmp_path, monkeypatch):
    gear = SimpleNamespace(resembles="gears")
    monkeypatch.setattr(run_method, "load_procedural_shapes", lambda *_: [gear, gear])
    with pytest.raises(BadParams, match=r"all 2 .* raise procedural\.solids"):
        run_method.pretrain_method(
            load_method("r2n2"), tmp_path, [], tmp_path, settings=None, seed=0, scratch=tmp_path
        )


def test_a_pretraining_depends_on_the_solids_and_its_own_settings(run):
    cfg = config()
    keys = [read_index(run(cfg)[1] / "r2n2")]
    longer = replace(cfg.method.r2n2.training, max_steps=77)
    cfg.method.r2n2 = replace(cfg.method.r2n2, training=longer)
    keys.append(read_index(run(cfg)[1] / "r2n2"))
    cfg.procedural = replace(cfg.procedural, solids=4)
    keys.append(read_index(run(cfg)[1] / "r2n2"))
    assert keys[0] == keys[1] != keys[2]  # of parts another training learns


def test_shipped_weights_are_those_of_the_folder(run, tmp_path):
    _, weights = run(config())
    trained = ModelState.load(weights / "r2n2" / "weights")
    shipped = tmp_path / "shipped" / "r2n2"
    shipped.mkdir(parents=True)
    arrays = {name: array.astype(np.float16) for name, array in trained.arrays.items()}
    replace(trained, arrays=arrays).save(shipped)
    solids, weights = run(config(weights="shipped"), "shipped")
    prior = prior_of("r2n2", solids, weights)
    for name, array in arrays.items():
        np.testing.assert_array_equal(prior.weights.arrays[name], array)


def test_weights_that_do_not_ship_name_the_knob(run):
    """Nothing starts at random that was to start from weights."""
    with pytest.raises(BadParams, match=r"no weights of r2n2 ship .*pretrain\.weights"):
        run(config(weights="shipped"))
    run(config(weights="shipped", methods=["retrieval"]))  # that asks for none


def test_without_weights_there_are_solids_alone(run):
    prior = prior_of("r2n2", *run(config(weights="none")))
    assert prior.weights is None
    assert len(prior.solids) == 3


def test_without_solids_there_is_nothing(run):
    solids, weights = run(config(solids=0, weights="none"))
    prior = prior_of("r2n2", solids, weights)
    assert prior.weights is None
    assert not prior.solids


def test_a_method_that_is_not_listed_is_not_pretrained(run):
    _, weights = run(config(methods=["retrieval"]))
    assert not (weights / "r2n2").exists()


def test_a_method_that_declares_no_solids_gets_none(tmp_path):
    """Nor are their files among what it depends on."""
    assert train.prior_of(load_method("retrieval"), tmp_path, tmp_path) == (None, [])


def test_solids_are_kept_chunk_by_chunk(run, monkeypatch):
    """More of them leave those that there are."""
    monkeypatch.setattr("industnerf.procedural_dataset.CHUNK", 2)
    first = read_index(run(config(solids=4, weights="none"))[0])
    solids, _ = run(config(solids=5, weights="none"))
    second = read_index(solids)
    assert len(first) == 2
    assert len(second) == 3
    assert first.items() <= second.items()
    assert len(load_procedural_shapes(solids, list(second))) == 5


@pytest.mark.parametrize(
    ("methods", "chunks"), [(("hull", "retrieval"), 0), (("hull", "retrieval_procedural"), 1)]
)
def test_solids_are_made_only_for_methods_that_learn_from_them(run, methods, chunks):
    """A sweep of pictures would else render thousands of solids anew at each of its points."""
    solids, _ = run(config(methods=methods))
    assert len(read_index(solids)) == chunks
