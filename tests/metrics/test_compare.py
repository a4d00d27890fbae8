"""Tolerances and Hausdorff-95 of clouds whose deviations are known."""

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.part import Mesh
from industnerf.metrics.compare import deviation_metrics
from industnerf.metrics.nearest_distances import nearest_distances
from industnerf.metrics.reference_rig import ReferenceSurface

SIDE = 20.0  # mm


def reference_box() -> ReferenceSurface:
    box = trimesh.creation.box([SIDE] * 3)
    return ReferenceSurface(Mesh.with_one_appearance(box.vertices, box.faces.astype(np.int32)))


def on_top(count: int, height: float) -> np.ndarray:
    """Points `height` mm above the upper face, well away from its edges."""
    flat = np.random.default_rng(0).uniform(-5, 5, size=(count, 2))
    return np.column_stack([flat, np.full(count, SIDE / 2 + height)])


def deviations(predicted_mm, truth_mm, tolerances=(0.1, 0.5, 1.0)):
    reference = reference_box()
    truth, predicted = reference.normalize(truth_mm), reference.normalize(predicted_mm)
    values = deviation_metrics(
        reference, predicted, nearest_distances(truth, predicted).truth_to_predicted, tolerances
    )
    assert {value.protocol for value in values} == {"P1-dense"}
    return {value.metric: value for value in values}


def test_shares_within_tolerances_are_of_the_cloud():
    predicted = np.concatenate([on_top(60, 0.05), on_top(30, 0.3), on_top(10, 2.0)])
    scores = deviations(predicted, on_top(10, 0.0))
    shares = [scores[f"within_{limit}mm"].value for limit in ("0.1", "0.5", "1")]
    assert shares == [0.6, 0.9, 0.9]
    assert not scores["within_0.1mm"].smaller_is_better


def test_shares_covered_are_of_the_surface():
    far = on_top(10, 0.0) + np.array([12.0, 0.0, 0.0])
    truth = np.concatenate([on_top(60, 0.0), on_top(30, -SIDE), far])
    cloud = np.concatenate([on_top(60, 0.05), on_top(30, -SIDE - 0.3)])
    scores = deviations(cloud, truth)
    shares = [scores[f"covered_{limit}mm"].value for limit in ("0.1", "0.5", "1")]
    assert shares == [0.6, 0.9, 0.9]
    assert [scores[f"within_{limit}mm"].value for limit in ("0.5", "1")] == [1.0, 1.0]
    assert not scores["covered_0.1mm"].smaller_is_better


def test_deviations_are_from_the_surface_not_from_its_samples():
    # the only sample is mm away; the surface is not
    scores = deviations(on_top(10, 0.05), np.array([[9.0, 9.0, SIDE / 2]]))
    assert scores["within_0.1mm"].value == 1.0


def test_hausdorff_95_leaves_out_a_twentieth_and_no_more():
    truth, up = on_top(100, 0.0), np.array([0.0, 0.0, 7.0])
    few = np.concatenate([truth[:96], truth[96:] + up])
    many = np.concatenate([truth[:90], truth[90:] + up])
    # every sample still has its nearest point within the spacing of the 90
    assert deviations(few, truth)["hausdorff95"].value < 1.5
    assert deviations(many, truth)["hausdorff95"].value == pytest.approx(7.0, abs=1e-4)


def test_hausdorff_95_misses_what_the_cloud_left_out():
    truth = np.concatenate([on_top(50, 0.0), on_top(50, -SIDE)])  # above and below
    missed = deviations(on_top(50, 0.0), truth)["hausdorff95"]
    assert missed.value == pytest.approx(SIDE, rel=1e-6)  # straight through
    assert missed.unit == "mm"
