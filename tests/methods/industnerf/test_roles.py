"""Which views speak and which judge: reading R10."""

import pytest

from industnerf.methods.industnerf.roles import view_roles


@pytest.mark.parametrize("count", [1, 2, 7, 40])
def test_a_view_that_is_left_out_judges_and_every_other_tells(count):
    views, roles = range(count), view_roles("left_out")
    telling, judging = set(views[roles.telling]), set(views[roles.judging])
    assert not telling & judging
    assert telling | judging == set(views)
    assert len(telling) - len(judging) in (0, 1)


def test_all_views_do_both_by_default():
    roles = view_roles("sources")
    assert list(range(7)[roles.telling]) == list(range(7)[roles.judging]) == list(range(7))
