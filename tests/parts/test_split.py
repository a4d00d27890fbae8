"""The split: stable under additions, families whole, dev only where something was tuned."""

from dataclasses import replace

import pytest

from industnerf.artifacts.split import Place, load_split, save_split, taught
from industnerf.parts.split import assign
from industnerf.schema import SplitParams
from tests.samples import unit_part

SETTINGS = SplitParams(dev_share=0.15, folds=3, hold_out="family")


def part(number, family="gears", origin="embedded"):
    return unit_part(f"p{number}", family, origin=origin)


MANY = [part(i, family=f"f{i % 40}") for i in range(1000)]


def test_adding_parts_moves_no_other_part():
    few, all_of_them = assign(MANY[::7], SETTINGS), assign(MANY, SETTINGS)
    assert few.items() <= all_of_them.items()


def test_the_dev_share_is_what_was_asked_for():
    dev = sum(place.split == "dev" for place in assign(MANY, SETTINGS).values())
    # binomial: 150 expected, standard deviation 11.3; the names are fixed, so this never flickers
    assert abs(dev - 150) < 3 * 11.3


def test_a_family_is_held_out_whole():
    places = assign(MANY, SETTINGS)
    for family in {p.family for p in MANY}:
        folds = {places[p.part_id].fold for p in MANY if p.family == family}
        assert len(folds) == 1


@pytest.mark.parametrize("split", ["dev", "test"])
@pytest.mark.parametrize("hold_out", ["family", "part"])
def test_every_fold_is_used_by_either_split(hold_out, split):
    places = assign(MANY, replace(SETTINGS, hold_out=hold_out)).values()
    assert {place.fold for place in places if place.split == split} == {0, 1, 2}


def test_parts_of_a_family_may_be_held_out_apart():
    places = assign(MANY, replace(SETTINGS, hold_out="part"))
    assert {places[p.part_id].fold for p in MANY if p.family == "f1"} == {0, 1, 2}


def test_a_net_learns_from_all_but_its_fold():
    places = {"a": Place("test", 0), "b": Place("dev", 1), "c": Place("test", 1)}
    assert taught(places, places["a"].net) == ["b", "c"]
    assert taught(places, places["c"].net) == ["a"]


def test_with_nothing_held_out_one_net_learns_from_all():
    places = assign(MANY, replace(SETTINGS, hold_out="none"))
    assert {place.net for place in places.values()} == {"all"}
    assert len(taught(places, "all")) == len(MANY)


def test_a_file_of_the_user_is_never_dev():
    own = [part(i, origin="file") for i in range(200)]
    assert {place.split for place in assign(own, SETTINGS).values()} == {"test"}


def test_the_split_survives_its_file(tmp_path):
    places = assign(MANY, SETTINGS)
    save_split(tmp_path / "split.json", places)
    assert load_split(tmp_path / "split.json") == places
