"""How many views each method is really given."""

from dataclasses import fields
from types import SimpleNamespace
from typing import get_type_hints

import pytest

from industnerf.config import load_params
from industnerf.methods import MODULES, load_method
from industnerf.report.given import SAID_BY, Views, views_of
from industnerf.schema import MethodSettings

NETS = SimpleNamespace(
    r2n2=SimpleNamespace(views=5),
    retrieval=SimpleNamespace(views=24),
    atlasnet=SimpleNamespace(views=24, answers=8),
    occupancy=SimpleNamespace(views=24, answers=3),
)


@pytest.mark.parametrize(
    ("name", "given"),
    [
        ("industnerf", Views(40)),
        ("hull", Views(40)),
        ("tsdf", Views(40)),
        ("r2n2", Views(5)),
        ("retrieval", Views(24)),
        ("atlasnet", Views(1, 8)),
        ("occupancy", Views(1, 3)),
        ("mean_shape", Views(0)),
        ("box", Views(0)),
        ("oracle", Views(0)),
    ],
)
def test_of_forty_views_it_is_given(name, given):
    assert views_of(load_method(name), 40, NETS) == given


def test_no_more_than_there_are():
    assert views_of(load_method("r2n2"), 4, NETS) == Views(4)
    assert views_of(load_method("atlasnet"), 4, NETS) == Views(1, 4)


def test_every_method_that_gives_several_answers_is_known_for_it(root):
    """Its schema has a setting of that name, and no other method's has."""
    sections = get_type_hints(MethodSettings)
    several = {name for name, kind in sections.items() if has_field(kind, "answers")}
    assert several == {name for name, key in SAID_BY.items() if key == "answers"}
    assert set(SAID_BY) <= set(MODULES)
    settings = load_params(root / "params.yaml").method
    assert all(getattr(getattr(settings, name), key) >= 1 for name, key in SAID_BY.items())


def has_field(kind, name):
    return name in {field.name for field in fields(kind)}
