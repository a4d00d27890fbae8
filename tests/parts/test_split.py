"""The split: stable under additions, families whole, dev only where something was tuned."""

from industnerf.artifacts.split import load_split, save_split
from industnerf.parts.split import assign
from industnerf.schema import SplitParams
from tests.samples import unit_part

SETTINGS = SplitParams(dev_share=0.15, folds=3)


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
        assert len(folds - {None}) == 1


def test_every_fold_is_used_and_dev_has_none():
    places = assign(MANY, SETTINGS).values()
    assert {place.fold for place in places if place.split == "test"} == {0, 1, 2}
    assert {place.fold for place in places if place.split == "dev"} == {None}


def test_a_file_of_the_user_is_never_dev():
    own = [part(i, origin="file") for i in range(200)]
    assert {place.split for place in assign(own, SETTINGS).values()} == {"test"}


def test_the_split_survives_its_file(tmp_path):
    places = assign(MANY, SETTINGS)
    save_split(tmp_path / "split.json", places)
    assert load_split(tmp_path / "split.json") == places
