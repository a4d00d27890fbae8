"""What the run is stopped for to look at."""

from dataclasses import replace

import torch

from industnerf.methods.industnerf.pipeline import run
from industnerf.methods.industnerf.point_levels import cell_indices
from industnerf.report.docs.method_figures.pipeline_trace import (
    CONFIDENCE_VIEWS,
    confidence_views,
    trace_pipeline,
)
from tests.report.docs.method_figures.conftest import ball_images


def test_looking_changes_nothing(trace):
    expected = run(trace.images, trace.settings, 0)
    assert (trace.cloud_mm == expected.points).all()
    assert (trace.confidence == expected.confidence).all()


def test_the_second_level_is_kept_and_sampled_points(trace):
    coarse = trace.coarse
    kept = {tuple(point) for point in trace.kept_points.tolist()}
    assert kept == {tuple(point) for point in coarse.points[coarse.sigma > 0].tolist()}
    assert len(trace.sampled_points) == trace.settings.levels[1].points


def test_points_are_sampled_only_in_cells_with_a_density(trace):
    cells, coarse = trace.settings.grid_res, trace.coarse
    filled = {tuple(cell) for cell in cell_indices(coarse.points[coarse.sigma > 0], cells).tolist()}
    assert {tuple(cell) for cell in cell_indices(trace.sampled_points, cells).tolist()} <= filled


def test_no_single_view_has_more_confidence_than_all_and_each_has_some(trace):
    fine = trace.fine
    assert len(fine.view_confidences) == CONFIDENCE_VIEWS
    single_view = torch.stack(list(fine.view_confidences.values()))
    # equal to the bit for the maximal view: the same samples in the same order
    assert (single_view <= fine.confidence).all()
    assert (single_view > 0).any(dim=1).all()
    assert (single_view < fine.confidence).any(dim=1).all()


def test_confidence_views_are_different_views():
    assert confidence_views(40, 30) == [30, 3, 16]
    assert confidence_views(2, 1) == [1, 0]


def test_to_mm_undoes_the_unit_frame(trace):
    corner = trace.to_mm(torch.tensor([[1.0, 0.0, -1.0]]))[0]
    assert (
        abs(
            corner - trace.images.center - trace.images.radius * torch.tensor([1, 0, -1]).numpy()
        ).max()
        < 1e-9
    )


def test_without_an_encoder_or_a_second_level_there_is_less_to_show(trace):
    settings = trace.settings
    reduced_settings = replace(
        settings, readings=replace(settings.readings, encoder="none"), levels=settings.levels[:1]
    )
    reduced = trace_pipeline("ball", ball_images(), reduced_settings, 0)
    assert reduced.coarse.features is None
    assert len(reduced.sampled_points) == len(reduced.kept_points) == 0
