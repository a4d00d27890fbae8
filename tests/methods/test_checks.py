"""What is refused of a method's results, with its reason."""

from dataclasses import replace

import numpy as np
import pytest

from industnerf.artifacts.candidates import Candidates
from industnerf.artifacts.renderings import Renderings
from industnerf.errors import ReconstructionFailed
from industnerf.methods.base import MethodInputs, Reconstruction
from industnerf.methods.checks import check_reconstruction, check_renderings
from tests.methods.solids import cameras_around

GIVEN = MethodInputs("any", cameras_around(3, 8, 50.0), cameras_around(2, 8, 50.0), {})
SQUARE = (2, 8, 8)
RENDERINGS = Renderings(
    np.zeros((*SQUARE, 3), np.uint8), np.ones(SQUARE, np.float32), np.zeros(SQUARE, np.uint8)
)
CANDIDATES = Candidates(np.zeros((4, 3), np.float32), np.ones(4, np.float32))
WHOLE = Reconstruction(
    np.zeros((2, 3)),
    confidence=np.ones(2),
    view=np.array([-1, 2]),
    candidates=CANDIDATES,
)


def test_a_whole_result_passes_as_it_is():
    assert check_reconstruction(WHOLE, GIVEN) is WHOLE


@pytest.mark.parametrize(
    ("points", "reason"),
    [
        (np.empty((0, 3)), "no point"),
        (np.array([[0, 0, 0], [np.nan, 0, 0], [0, np.inf, 0]]), "2 of 3 points"),
    ],
)
def test_no_point_or_one_that_is_not_finite_is_a_failure(points, reason):
    with pytest.raises(ReconstructionFailed, match=reason):
        check_reconstruction(Reconstruction(points), GIVEN)


@pytest.mark.parametrize(
    ("spoilt", "reason"),
    [
        ({"confidence": np.array([1, np.nan])}, "1 of 2 values of confidence"),
        ({"view": np.array([0, 3])}, "1 of 2 points name a training view .* such as 3 of 3"),
        ({"view": np.array([-2, -1])}, "such as -2 of 3"),
        (
            {"candidates": replace(CANDIDATES, points_mm=np.full((4, 3), np.inf, np.float32))},
            "4 of 4 candidates",
        ),
        (
            {"candidates": replace(CANDIDATES, confidence=np.full(4, np.nan, np.float32))},
            "4 of 4 values of the candidates' confidence",
        ),
    ],
)
def test_what_comes_with_the_points_must_be_usable_too(spoilt, reason):
    with pytest.raises(ReconstructionFailed, match=reason):
        check_reconstruction(replace(WHOLE, **spoilt), GIVEN)


@pytest.mark.parametrize(
    ("spoilt", "reason"),
    [
        (
            replace(RENDERINGS, depth_mm=np.full(SQUARE, np.nan, np.float32)),
            "16 of 16 rendered rows of depth",
        ),
        (replace(RENDERINGS, depth_mm=np.full(SQUARE, -1, np.float32)), "behind the camera"),
        (
            Renderings(*(a[:1] for a in vars(RENDERINGS).values())),
            r"shape \(1, 8, 8\), the held-out cameras \(2, 8, 8\)",
        ),
    ],
)
def test_pictures_are_of_the_views_asked_for_and_nothing_is_behind_the_camera(spoilt, reason):
    assert check_renderings(RENDERINGS, GIVEN) is RENDERINGS
    with pytest.raises(ReconstructionFailed, match=reason):
        check_renderings(spoilt, GIVEN)
