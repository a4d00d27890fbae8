"""How many views each method is really given."""

from dataclasses import fields
from types import SimpleNamespace
from typing import get_type_hints

import pytest

from industnerf.config import load_params
from industnerf.methods import MODULES, load_method
from industnerf.report.study import LIMITED_BY, InputViews, input_views_of
from industnerf.schema import MethodSettings

NETWORK_SETTINGS = SimpleNamespace(
    r2n2=SimpleNamespace(max_views=5),
    retrieval=SimpleNamespace(views=24),
    atlasnet=SimpleNamespace(train_views=24, eval_views=8),
    occupancy=SimpleNamespace(train_views=24, eval_views=3),
)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("industnerf", InputViews(40)),
        ("hull", InputViews(40)),
        ("tsdf", InputViews(40)),
        ("r2n2", InputViews(5)),
        ("retrieval", InputViews(24)),
        ("atlasnet", InputViews(1, 8)),
        ("occupancy", InputViews(1, 3)),
        ("mean_shape", InputViews(0)),
        ("box", InputViews(0)),
        ("oracle", InputViews(0)),
    ],
)
def test_of_forty_views_it_is_given(name, expected):
    assert input_views_of(load_method(name), 40, NETWORK_SETTINGS) == expected


def test_no_more_than_there_are():
    assert input_views_of(load_method("r2n2"), 4, NETWORK_SETTINGS) == InputViews(4)
    assert input_views_of(load_method("atlasnet"), 4, NETWORK_SETTINGS) == InputViews(1, 4)


def test_every_method_that_gives_several_predictions_is_known_for_it(root):
    """Its schema has a setting of that name, and no other method's has."""
    sections = get_type_hints(MethodSettings)
    multi_prediction = {name for name, kind in sections.items() if has_field(kind, "eval_views")}
    assert multi_prediction == {name for name, key in LIMITED_BY.items() if key == "eval_views"}
    assert set(LIMITED_BY) <= set(MODULES)
    settings = load_params(root / "params.yaml").method
    assert all(getattr(getattr(settings, name), key) >= 1 for name, key in LIMITED_BY.items())


def has_field(kind, name):
    return name in {field.name for field in fields(kind)}
