"""Which views speak and which judge: reading R10."""

import pytest

from industnerf.methods.industnerf.view_split import source_target_split


@pytest.mark.parametrize("count", [1, 2, 7, 40])
def test_a_view_that_is_left_out_judges_and_every_other_tells(count):
    views, split = range(count), source_target_split("left_out")
    source, target = set(views[split.source]), set(views[split.target])
    assert not source & target
    assert source | target == set(views)
    assert len(source) - len(target) in (0, 1)


def test_all_views_do_both_by_default():
    split = source_target_split("sources")
    assert list(range(7)[split.source]) == list(range(7)[split.target]) == list(range(7))
