"""Choices by hash: fixed, and moved by nothing but the parts themselves."""

from dataclasses import replace

from industnerf.report.part_subsets import figure3_parts, order_by_hash, select_viewer_parts
from industnerf.report.study import StudyFolders
from tests.samples import unit_part
from tests.studies import make_study

PARTS = [unit_part(f"{family}{i}", family) for family in "fgh" for i in range(5)]


def test_figure_3_shows_one_test_part_of_each_family():
    study = make_study(PARTS, {"hull": [0.1] * 15}, dev=["f0", "f1", "g0"])
    figure3_ids = figure3_parts(study)
    assert sorted(name[0] for name in figure3_ids) == list("fgh")
    assert figure3_ids.isdisjoint({"f0", "f1", "g0"})


def test_neither_results_nor_seed_nor_other_families_move_it():
    study = make_study(PARTS, {"hull": [0.1] * 15})
    assert figure3_parts(replace(study, seed=7, scores=[])) == figure3_parts(study)
    fewer = make_study(PARTS[5:], {"hull": [0.1] * 10})
    assert figure3_parts(fewer) == {name for name in figure3_parts(study) if name[0] != "f"}


def test_a_part_that_goes_leaves_the_others_in_their_order():
    names = [part.part_id for part in PARTS]
    order = order_by_hash("seeds", names)
    assert sorted(order) == names
    assert order != names
    assert order_by_hash("seeds", names[1:]) == [name for name in order if name != names[0]]
    assert order_by_hash("figure3", names) != order


def test_one_part_of_each_family_is_chosen_before_a_second(tmp_path):
    study = make_study(PARTS, {"hull": [0.1] * 15}, dev=["f0", "f1", "g0"])
    study = replace(study, folders=StudyFolders.all_at(tmp_path))
    for part in PARTS:
        (tmp_path / part.part_id).mkdir()
    (missing,) = (name for name in figure3_parts(study) if name[0] == "h")
    assert {part.part_id for part in select_viewer_parts(study, 3)} == figure3_parts(study)
    assert [part.part_id for part in select_viewer_parts(study, 99)] == [
        part.part_id for part in PARTS
    ]
    four = select_viewer_parts(study, 4)
    assert [part.family for part in four] == sorted(part.family for part in four)
    assert figure3_parts(study) < {part.part_id for part in four}
    (tmp_path / missing).rmdir()
    assert missing not in {part.part_id for part in select_viewer_parts(study, 99)}
