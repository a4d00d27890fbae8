"""The additions put together: what training starts from, and what constrains it."""

from dataclasses import replace

import torch

from industnerf.methods.industnerf.field import Field
from industnerf.methods.industnerf.point_levels import PointLevel, grid_spacing, initial_grid
from industnerf.methods.industnerf.trainer import Trainer
from industnerf.methods.industnerf_plus.photo_hull import PhotoHull
from industnerf.methods.industnerf_plus.pipeline import PlusVariant
from tests.methods.industnerf.synthetic_scenes import (
    CPU,
    ball,
    make_posed_images,
    make_silhouettes,
    make_test_scene,
    settings,
)

RES = 12
SPACING = grid_spacing(RES, 0)
GRID = initial_grid(SPACING, CPU)


def make_sdf_trainer(
    raw: torch.Tensor | None = None, photo_hull: PhotoHull | None = None
) -> tuple[Trainer, torch.Tensor]:
    """Of a ball, from these distances at the points of the first grid; and their distance from the
    visual hull, in spacings."""
    sdf = settings("industnerf_plus").sdf
    sdf = replace(sdf, init=replace(sdf.init, enabled=False))  # made of no photographs
    config = settings("industnerf_plus", grid_res=RES, max_grid_points=0, sdf=sdf)
    views = make_test_scene(ball(18.0), 6, 48)
    variant = PlusVariant(views, make_posed_images(ball(18.0), 6, 48), config)
    variant._photo_hull = photo_hull
    residuals = None if raw is None else (raw, torch.full((len(raw), 3), 0.5))
    level_points = PointLevel(GRID, SPACING, residuals=residuals)
    field, generator = Field(views, config), torch.Generator()
    trainer = Trainer(views, field, level_points, 0, config, generator, variant.constraints)
    return trainer, make_silhouettes(views).distance(trainer.points.positions) / SPACING


def test_distances_start_from_the_last_level_and_nowhere_deeper_than_the_hull():
    last = torch.linspace(-3, 3, len(GRID))
    trainer, hull = make_sdf_trainer(last)
    expected = torch.maximum(last[trainer.points.order], hull)
    assert torch.equal(trainer.field.raw.detach(), expected)


def test_distances_start_at_the_photo_hull_where_that_is_deeper_inside_than_the_hull():
    class Inner(PhotoHull):
        def __init__(self) -> None:
            """Made of no photographs."""
            self.is_reliable = True

        def distance(self, points: torch.Tensor) -> torch.Tensor:
            return torch.full((len(points),), 2 * SPACING)

    trainer, hull = make_sdf_trainer(photo_hull=Inner())
    assert (hull < 2).any()
    torch.testing.assert_close(trainer.field.raw.detach(), hull.clamp(min=2.0))


def test_what_views_say_of_a_hard_surface_needs_no_space_where_only_a_soft_one_has_density(
    monkeypatch,
):
    trainer, _ = make_sdf_trainer(torch.full((len(GRID),), -9.0))
    assert trainer.settings.beta.render < trainer.beta()
    filled = []
    monkeypatch.setattr(trainer, "_set_has_density", lambda which: filled.append(int(which.sum())))
    everywhere = trainer.view_confidence()  # rays skip nothing yet
    monkeypatch.undo()
    skipping = trainer.view_confidence()
    assert 0 < filled[0] < int((trainer.density() > 0).sum())
    assert torch.equal(skipping.per_view, everywhere.per_view)
    for name, value in vars(skipping.surface).items():
        assert torch.equal(value, getattr(everywhere.surface, name)), name
