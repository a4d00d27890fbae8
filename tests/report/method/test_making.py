"""What the run is stopped for to look at."""

from dataclasses import replace

import torch

from industnerf.methods.industnerf.levels import cells_of
from industnerf.methods.industnerf.run import run
from industnerf.report.method.making import WITNESSES, make, witnesses_of
from tests.report.method.conftest import photographs


def test_looking_changes_nothing(making):
    ends = run(making.posed, making.settings, 0)
    assert (making.cloud_mm == ends.points).all()
    assert (making.confidence == ends.confidence).all()


def test_the_second_level_is_what_was_kept_and_what_was_drawn(making):
    coarse = making.coarse
    kept = {tuple(point) for point in making.kept.tolist()}
    assert kept == {tuple(point) for point in coarse.points[coarse.sigma > 0].tolist()}
    assert len(making.drawn) == making.settings.levels[1].points


def test_points_are_drawn_only_from_cells_with_a_density(making):
    cells, coarse = making.settings.grid_res, making.coarse
    filled = {tuple(cell) for cell in cells_of(coarse.points[coarse.sigma > 0], cells).tolist()}
    assert {tuple(cell) for cell in cells_of(making.drawn, cells).tolist()} <= filled


def test_no_view_alone_is_surer_than_all_and_each_is_sure_of_something(making):
    fine = making.fine
    assert len(fine.witnesses) == WITNESSES
    alone = torch.stack(list(fine.witnesses.values()))
    # equal to the bit where a view is the surest: it has the same samples in the same order
    assert (alone <= fine.confidence).all()
    assert (alone > 0).any(dim=1).all()
    assert (alone < fine.confidence).any(dim=1).all()  # none speaks for the others


def test_witnesses_are_different_views():
    assert witnesses_of(40, 30) == [30, 3, 16]
    assert witnesses_of(2, 1) == [1, 0]


def test_in_mm_undoes_the_unit_frame(making):
    corner = making.in_mm(torch.tensor([[1.0, 0.0, -1.0]]))[0]
    assert (
        abs(
            corner - making.posed.centre - making.posed.radius * torch.tensor([1, 0, -1]).numpy()
        ).max()
        < 1e-9
    )


def test_without_an_encoder_or_a_second_level_there_is_less_to_show(making):
    ways = making.settings
    blind = replace(ways, readings=replace(ways.readings, encoder="none"), levels=ways.levels[:1])
    less = make("ball", photographs(), blind, 0)
    assert less.coarse.features is None
    assert len(less.drawn) == len(less.kept) == 0
