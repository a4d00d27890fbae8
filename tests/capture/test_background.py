"""Backgrounds: exact in 8 bits, and another in each view if random."""

from dataclasses import replace

import numpy as np
import pytest

from industnerf.capture.background import backgrounds
from industnerf.capture.rng import random_streams


@pytest.mark.parametrize(("name", "level"), [("white", 255), ("gray", 128), ("black", 0)])
def test_a_named_background_is_the_same_in_all_views(settings, name, level):
    levels = backgrounds(replace(settings, background=name), random_streams(0, "part", settings))
    np.testing.assert_array_equal(levels, np.full((6, 3), level / 255))


def test_random_backgrounds_differ_and_are_whole_levels(shipped):
    settings = replace(shipped, background="random", count=392)
    levels = 255 * backgrounds(settings, random_streams(0, "part", settings))
    np.testing.assert_allclose(levels, np.rint(levels), rtol=0, atol=1e-9)
    assert len(np.unique(levels, axis=0)) == 400
    # 1200 levels, uniform: their mean is 127.5 to 73.9 / sqrt(1200) = 2.1; five times that is
    # chance once in 1e6
    assert levels.mean() == pytest.approx(127.5, abs=10.7)
    other = 255 * backgrounds(settings, random_streams(1, "part", settings))
    assert not np.array_equal(levels, other)
