"""Cost against quality: who is on the front."""

import io

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from industnerf.report.pareto import front, pareto
from industnerf.report.table1 import table1
from industnerf.report.table1_text import Extra
from tests.report.conftest import SETTINGS

LEVELS = [0.5, 1.0, 2.0, 4.0, 8.0]
PLACES = st.lists(st.tuples(st.sampled_from(LEVELS), st.sampled_from(LEVELS)), min_size=1)


def slow_front(points):
    """By comparing every pair."""
    return sorted(
        {p for p in points if not any(q != p and q[0] <= p[0] and q[1] <= p[1] for q in points)}
    )


@given(PLACES)
def test_the_front_is_what_nothing_beats_at_both(points):
    assert front(points) == slow_front(points)


def test_it_is_drawn_with_the_seconds_that_are_known_and_without_any(study):
    rows = table1(study, SETTINGS)
    blue = []
    for known in (True, False):
        extras = [Extra(row.emd_even, 10.0**i if known else None) for i, row in enumerate(rows)]
        picture = Image.open(io.BytesIO(pareto(rows, extras))).convert("RGB")
        red, _, strong = np.moveaxis(np.asarray(picture).astype(int), 2, 0)
        blue.append(int((strong - red > 60).sum()))
    assert blue[0] > 50
    assert blue[1] == 0
