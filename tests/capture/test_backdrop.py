"""Backgrounds: exact in 8 bits, and another in each view if random."""

from dataclasses import replace

import numpy as np
import pytest

from industnerf.capture.backdrop import backgrounds
from industnerf.capture.chance import draws_of


@pytest.mark.parametrize(("name", "level"), [("white", 255), ("grey", 128), ("black", 0)])
def test_a_named_background_is_the_same_in_all_views(settings, name, level):
    found = backgrounds(replace(settings, background=name), draws_of(0, "part", settings))
    np.testing.assert_array_equal(found, np.full((6, 3), level / 255))


def test_random_backgrounds_differ_and_are_whole_levels(shipped):
    settings = replace(shipped, background="random", count=392)
    found = 255 * backgrounds(settings, draws_of(0, "part", settings))
    np.testing.assert_allclose(found, np.rint(found), rtol=0, atol=1e-9)
    assert len(np.unique(found, axis=0)) == 400
    # 1200 levels, uniform: their mean is 127.5 to 73.9 / sqrt(1200) = 2.1; five times that is
    # chance once in 1e6
    assert found.mean() == pytest.approx(127.5, abs=10.7)
    other = 255 * backgrounds(settings, draws_of(1, "part", settings))
    assert not np.array_equal(found, other)
