"""What the net is taught, against closed forms."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from torch import nn

from industnerf.artifacts.part import load_mesh
from industnerf.geometry.bounding_cube import BoundingCube
from industnerf.learning.view_sampler import ViewSampler
from industnerf.methods import load_method
from industnerf.methods.base import Example
from industnerf.methods.occupancy.dataset import OccupancyDataset
from industnerf.methods.occupancy.network import OccupancyNet
from industnerf.schema import AugmentSettings, OccupancySettings
from tests.methods.conftest import OFFSET, SIZE
from tests.methods.test_conformance import merged

SMALL = merged("params.yaml", "conf/experiment/smoke.yaml").method.occupancy
STRONG = replace(
    SMALL, augment=AugmentSettings(roll_deg=180.0, zoom=0.5, color_jitter=0.5, noise=0.0)
)


def make_dataset(settings: OccupancySettings) -> OccupancyDataset:
    """Two parts of random pictures; all of space is inside the first and outside the second."""
    rng = np.random.default_rng(0)
    images = [rng.integers(0, 256, (count, 32, 32, 3), np.uint8) for count in (3, 2)]
    points = rng.random((2, 40, 3), np.float32)
    rotations = [np.tile(np.eye(3), (count, 1, 1)) for count in (3, 2)]
    view_sampler = ViewSampler(images, rotations, settings.augment, settings.output_axes)
    inside = np.stack([np.ones(40, bool), np.zeros(40, bool)])
    return OccupancyDataset(view_sampler, points, inside, settings.points_subsample)


def constant_net(constant: float | None = None) -> OccupancyNet:
    """A net at random, or one that gives everything the same logit."""
    torch.manual_seed(0)
    made = OccupancyNet(SMALL)
    if constant is not None:
        nn.init.zeros_(made.decoder.last.weight)
        nn.init.constant_(made.decoder.last.bias, constant)
    else:
        nn.init.normal_(made.decoder.norm.scale.weight)  # or no picture would matter
    return made


def test_the_loss_is_summed_over_points_and_averaged_over_parts():
    logit = 0.7
    result = make_dataset(SMALL).loss(
        constant_net(logit), np.array([0, 1, 1]), np.random.default_rng(1)
    )
    inside, outside = np.log1p(np.exp(-logit)), np.log1p(np.exp(logit))
    assert result.item() == pytest.approx(
        SMALL.points_subsample * (inside + 2 * outside) / 3, rel=1e-5
    )


def test_pictures_vary_while_the_net_learns_and_not_when_it_is_asked():
    def loss(settings: OccupancySettings, learns: bool) -> float:
        rng, part_indices = np.random.default_rng(2), np.array([0, 1, 0, 1])
        with torch.no_grad():
            return (
                make_dataset(settings).loss(constant_net().train(learns), part_indices, rng).item()
            )

    assert loss(STRONG, learns=False) == loss(SMALL, learns=False)
    assert loss(STRONG, learns=True) != loss(SMALL, learns=True)


def test_points_are_of_the_enlarged_cube_and_known_to_be_inside(rendered_part: Path):
    inputs = load_method("occupancy").inputs
    example = Example("part", "part", rendered_part / "part", rendered_part / "views", inputs)
    dataset = OccupancyDataset.of([example, example], SMALL, np.random.default_rng(3))
    assert [x.shape for x in dataset.view_sampler.images] == [(SMALL.train_views, 32, 32, 3)] * 2
    half_width = (1 + SMALL.padding) / 2
    assert 0.99 * half_width < np.abs(dataset.points).max() <= half_width
    # the box without the ball on its side
    part_frame = BoundingCube.of(load_mesh(rendered_part / "part").vertices)
    points = part_frame.to_mm(dataset.points.reshape(-1, 3).astype(float)).reshape(
        dataset.points.shape
    )
    inner = (np.abs(points - OFFSET) < SIZE / 2).all(axis=2)
    assert dataset.inside[inner].all()
    assert inner.any()
    assert 0.9 < inner.sum() / dataset.inside.sum() < 1
