"""Sparsification curves over parts, and what is drawn of them."""

import io

import numpy as np
import pytest
from PIL import Image

from industnerf.artifacts.scores import PartScore, Score
from industnerf.report.figures.sparsification import plot_sparsification, sparsification_curves
from tests.samples import unit_part
from tests.studies import make_study

REMOVED = range(10, 100, 10)
PARTS = [unit_part(name, name) for name in "abc"]


@pytest.fixture
def study():
    """Of two test parts and a dev part the hull has confidences; the box has none."""
    with_confidence = make_study(PARTS, {"hull": [0.1] * 3, "box": [0.2] * 3}, dev="c")
    for part, slope in (("a", 0.2), ("b", 0.4), ("c", 0.9)):
        for percent in REMOVED:
            error_left, oracle_error = 1 - slope * percent / 100, 1 - percent / 100
            score = Score(f"error_left_{percent}", "P1-near", error_left, oracle_error, "1", "ok")
            with_confidence.scores.append(PartScore(part, "hull", score))
    return with_confidence


def test_a_curve_is_the_mean_over_the_test_parts(study):
    by_method = sparsification_curves(study)
    assert set(by_method) == {"hull"}
    removed = by_method["hull"].removed / 100
    np.testing.assert_allclose(removed, np.arange(10) / 10, atol=1e-12)
    np.testing.assert_allclose(by_method["hull"].by_confidence, 1 - 0.3 * removed, atol=1e-12)
    np.testing.assert_allclose(by_method["hull"].by_error, 1 - removed, atol=1e-12)
    assert by_method["hull"].parts == 2


def test_it_is_drawn_only_where_there_is_a_curve(study):
    assert Image.open(io.BytesIO(plot_sparsification(study))).width > 500
    study.scores.clear()
    assert plot_sparsification(study) is None
