"""The weights that ship are those that params.yaml would train, and their cards say so."""

import json
from dataclasses import asdict

import pytest

from industnerf.artifacts.state import ModelState
from industnerf.config import load_params
from pipeline.publish_weights import NETWORKS, SHIPPED, arrays_digest


@pytest.mark.parametrize("name", NETWORKS)
def test_a_card_describes_its_weights(name, root):
    card = json.loads((root / SHIPPED / name / "card.json").read_text())
    assert card["sha256"] == arrays_digest(ModelState.load(root / SHIPPED / name).arrays)


@pytest.mark.parametrize("name", NETWORKS)
def test_weights_that_ship_were_trained_as_params_yaml_says(name, root):
    card = json.loads((root / SHIPPED / name / "card.json").read_text())
    params = load_params()
    pretraining = asdict(getattr(params.method, name).pretraining)
    keep = pretraining.pop("keep")  # some cards are older than this setting
    assert card["settings"]["pretraining"] in (pretraining, pretraining | {"keep": keep})
    assert card["procedural"] == asdict(params.procedural)
    assert card["seed"] == params.seed
