"""Nested settings to dotted keys."""

from industnerf.config import flatten


def test_sections_in_a_list_stand_apart_and_other_lists_are_values():
    values = {"a": 1, "b": {"c": [1, 2], "d": []}, "levels": [{"n": 3}, {"n": 4, "m": {"k": 5}}]}
    assert flatten(values, split_lists=True) == {
        "a": 1,
        "b.c": [1, 2],
        "b.d": [],
        "levels[0].n": 3,
        "levels[1].n": 4,
        "levels[1].m.k": 5,
    }


def test_a_list_is_one_value_unless_it_is_to_be_split():
    values = {"a": {"b": [{"n": 3}], "c": {}}}
    assert flatten(values) == {"a.b": [{"n": 3}]}
