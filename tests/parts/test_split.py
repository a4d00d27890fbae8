"""The split: stable under additions, families whole, dev only where something was tuned."""

from dataclasses import replace

import pytest

from industnerf.artifacts.split import SplitAssignment, load_split, save_split, train_parts
from industnerf.parts.split import assign_splits
from industnerf.schema import SplitParams
from tests.samples import unit_part

SETTINGS = SplitParams(dev_fraction=0.15, folds=3, hold_out="family")


def part(number, family="gears", origin="embedded"):
    return unit_part(f"p{number}", family, origin=origin)


MANY = [part(i, family=f"f{i % 40}") for i in range(1000)]


def test_adding_parts_moves_no_other_part():
    few, all_of_them = assign_splits(MANY[::7], SETTINGS), assign_splits(MANY, SETTINGS)
    assert few.items() <= all_of_them.items()


def test_the_dev_share_is_what_was_asked_for():
    dev = sum(assignment.split == "dev" for assignment in assign_splits(MANY, SETTINGS).values())
    # binomial: 150 expected, standard deviation 11.3; the names are fixed, so this never flickers
    assert abs(dev - 150) < 3 * 11.3


def test_a_family_is_held_out_whole():
    splits = assign_splits(MANY, SETTINGS)
    for family in {p.family for p in MANY}:
        folds = {splits[p.part_id].fold for p in MANY if p.family == family}
        assert len(folds) == 1


@pytest.mark.parametrize("split", ["dev", "test"])
@pytest.mark.parametrize("hold_out", ["family", "part"])
def test_every_fold_is_used_by_either_split(hold_out, split):
    splits = assign_splits(MANY, replace(SETTINGS, hold_out=hold_out)).values()
    assert {assignment.fold for assignment in splits if assignment.split == split} == {0, 1, 2}


def test_parts_of_a_family_may_be_held_out_apart():
    splits = assign_splits(MANY, replace(SETTINGS, hold_out="part"))
    assert {splits[p.part_id].fold for p in MANY if p.family == "f1"} == {0, 1, 2}


def test_a_net_learns_from_all_but_its_fold():
    splits = {
        "a": SplitAssignment("test", 0),
        "b": SplitAssignment("dev", 1),
        "c": SplitAssignment("test", 1),
    }
    assert train_parts(splits, splits["a"].net_name) == ["b", "c"]
    assert train_parts(splits, splits["c"].net_name) == ["a"]


def test_with_nothing_held_out_one_net_learns_from_all():
    splits = assign_splits(MANY, replace(SETTINGS, hold_out="none"))
    assert {assignment.net_name for assignment in splits.values()} == {"all"}
    assert len(train_parts(splits, "all")) == len(MANY)


def test_a_file_of_the_user_is_never_dev():
    user_parts = [part(i, origin="file") for i in range(200)]
    assert {assignment.split for assignment in assign_splits(user_parts, SETTINGS).values()} == {
        "test"
    }


def test_the_split_survives_its_file(tmp_path):
    splits = assign_splits(MANY, SETTINGS)
    save_split(tmp_path / "split.json", splits)
    assert load_split(tmp_path / "split.json") == splits
