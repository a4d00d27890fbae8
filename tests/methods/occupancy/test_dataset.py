"""What the net is taught, against closed forms."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from scipy.spatial.transform import Rotation
from torch import nn

from industnerf.artifacts.part import load_mesh
from industnerf.geometry.bounding_cube import BoundingCube
from industnerf.learning.targets import PADDING, OccupancyPool
from industnerf.learning.view_sampler import ViewSampler
from industnerf.methods import load_method
from industnerf.methods.base import Example
from industnerf.methods.occupancy.dataset import OccupancyDataset, decoder_points
from industnerf.methods.occupancy.network import OccupancyNet
from industnerf.schema import AugmentSettings, OccupancySettings
from tests.methods.conftest import OFFSET, SIZE
from tests.methods.test_conformance import merged

SMALL = merged("params.yaml", "conf/experiment/smoke.yaml").method.occupancy
STRONG = replace(
    SMALL, augment=AugmentSettings(roll_deg=180.0, zoom=0.5, color_jitter=0.5, noise=0.0)
)


def make_dataset(settings: OccupancySettings) -> OccupancyDataset:
    """Two parts of random pictures; half of the cube is inside the first, little of the second."""
    rng = np.random.default_rng(0)
    images = [rng.integers(0, 256, (count, 32, 32, 3), np.uint8) for count in (3, 2)]
    backgrounds, frames = (
        [np.ones((n, 3)) for n in (3, 2)],
        [np.tile(np.eye(3), (n, 1, 1)) for n in (3, 2)],
    )
    pools = [
        OccupancyPool(rng.random((40, 3), np.float32).astype(np.float16), np.float32(shares))
        for shares in ([0.5, 0.2, 0.3], [0.03, 0.07, 0.9])
    ]
    view_sampler = ViewSampler(images, backgrounds, frames, settings.augment)
    return OccupancyDataset(view_sampler, pools, settings.points_subsample, settings.query_axes)


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


def test_the_loss_is_the_mean_over_the_cube_and_over_parts():
    """However many of the points are drawn inside."""
    logit = 0.7
    result = make_dataset(SMALL).loss(
        constant_net(logit), np.array([0, 1, 1]), np.random.default_rng(1)
    )
    inside, outside = np.log1p(np.exp(-logit)), np.log1p(np.exp(logit))
    share = (0.5 + 2 * 0.03) / 3
    assert result.item() == pytest.approx(share * inside + (1 - share) * outside, rel=1e-5)


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
    part_frame = BoundingCube.of(load_mesh(rendered_part / "part").vertices)
    for pool in dataset.pools:
        assert pool.points.shape == (SMALL.points_per_part, 3)
        half_width = (1 + PADDING) / 2
        assert 0.99 * half_width < np.abs(pool.points).max() < 1.001 * half_width
        # the box without the ball on its side; float16 is off by 1e-4
        offsets = np.abs(part_frame.to_mm(pool.points.astype(float)) - OFFSET) - SIZE / 2
        inner = (offsets < -0.02).all(axis=1)
        known = np.arange(len(inner)) < SMALL.points_per_part / 2
        assert not inner[~known].any()
        assert 0.9 < inner.sum() / known.sum() < 1


TURN = Rotation.from_euler("xyz", [0.4, -0.7, 1.1]).as_matrix()


@pytest.mark.parametrize("axes", ["part", "picture", "both"])
def test_the_decoder_takes_points_in_the_axes_that_it_knows(axes):
    """What is 1 along x in the part is seen along the frame's first row."""
    points = np.concatenate([np.eye(3), np.random.default_rng(0).random((5, 3))])[None]
    frames = 0.7 * TURN[None]
    in_picture = np.concatenate([0.7 * TURN, points[0, 3:] @ (0.7 * TURN)])
    expected = {"part": [points[0]], "picture": [in_picture], "both": [in_picture, points[0]]}[axes]
    result = decoder_points(points, frames, axes)
    assert result.dtype == np.float32
    np.testing.assert_allclose(result[0], np.concatenate(expected, axis=1), rtol=0, atol=1e-6)


def test_a_net_of_both_axes_is_taught_the_frame_of_the_view_that_it_sees():
    """Every view has a gray of its own, and a frame of so many times its axes."""
    dataset, seen = make_dataset(replace(SMALL, query_axes="both")), []
    sampler = dataset.view_sampler
    for part, images in enumerate(sampler.images):
        for view, image in enumerate(images):
            image[:] = 10 + 100 * part + 20 * view
            sampler.frames[part][view] = (1 + part + view / 10) * np.eye(3)
    still = replace(sampler, augment=AugmentSettings(0.0, 0.0, 0.0, 0.0))

    def record(contrasts, points):
        seen.append((contrasts, points))
        return points[..., 0]

    net = constant_net(0.0)
    net.forward = record
    replace(dataset, view_sampler=still).loss(net, np.array([0, 1, 0, 1]), np.random.default_rng(0))
    (contrasts, points), *_ = seen
    gray = (255 * (1 - contrasts.mean(dim=(1, 2, 3)))).round()
    view = (gray - 10) % 100 / 20
    factor = (points[..., :3] / points[..., 3:]).flatten(1)
    expected = (1 + torch.tensor([0, 1, 0, 1]) + view / 10)[:, None].expand_as(factor)
    torch.testing.assert_close(factor, expected, rtol=1e-4, atol=0)
