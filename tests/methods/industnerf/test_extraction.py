"""From confidence to the cloud, by each reading."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from industnerf.config import load_params
from industnerf.methods.industnerf import witnesses  # a class called Test... would be collected
from industnerf.methods.industnerf.extraction import final_cloud
from industnerf.methods.industnerf.fused import fused
from industnerf.methods.industnerf.scene import Posed
from industnerf.methods.industnerf.witnesses import Surface, thinned
from tests.methods.solids import cameras_around

CAMERAS = cameras_around(5, 32, 1.0)
POSED = Posed(np.zeros((5, 32, 32, 3), np.uint8), CAMERAS, None, np.zeros(3), 1.0)
WAYS = load_params(Path(__file__).parents[3] / "params.yaml").method.industnerf


def some(count: int, seed: int) -> Surface:
    generator = torch.Generator().manual_seed(seed)
    points, rgb = (torch.rand(count, 3, generator=generator) for _ in range(2))
    view = torch.randint(0, 5, (count,), generator=generator)
    return Surface(points, rgb, torch.linspace(0, 1, count), view)


MEMBERS, SEEN = some(21, 0), some(41, 1)
TOLD = witnesses.Testimony(MEMBERS.confidence, MEMBERS.view, SEEN, MEMBERS.confidence[None])


def cloud(least: float, reading: str, spacing: float = 0.2) -> Surface:
    return told_by(TOLD, least, reading, spacing)


def told_by(told: witnesses.Testimony, least: float, reading: str, spacing: float = 0.2) -> Surface:
    ways = replace(
        WAYS,
        surface_px=32,
        least_confidence=least,
        spacing=spacing,
        fusion=replace(WAYS.fusion, grid_res=16, points=500),
    )
    return final_cloud(MEMBERS.points, MEMBERS.rgb, told, POSED, ways, reading, 7)


def assert_same(a: Surface, b: Surface) -> None:
    for name in vars(a):
        assert torch.equal(getattr(a, name), getattr(b, name)), name


@pytest.mark.parametrize(("least", "kept"), [(0.0, 20), (0.5, 11), (0.52, 10), (1.0, 1)])
def test_confident_points_are_the_clouds_own(least, kept):
    """The steps of confidence are 0.05; at the threshold a point stays, at 0 it never does."""
    found = cloud(least, "confident")
    assert len(found.points) == kept
    assert_same(found, Surface(*(values[-kept:] for values in vars(MEMBERS).values())))


@pytest.mark.parametrize(("least", "kept"), [(0.0, 41), (0.5, 21)])
def test_surface_points_are_those_of_sure_pixels_thinned(least, kept):
    rest = Surface(*(values[-kept:] for values in vars(SEEN).values()))
    assert_same(cloud(least, "surface"), thinned(rest, 0.2))
    fine = cloud(least, "surface", 1e-4)
    assert len(fine.points) == kept


def test_fused_points_are_those_of_the_surface_that_the_views_agree_on():
    ways = replace(
        WAYS,
        surface_px=32,
        least_confidence=0.5,
        fusion=replace(WAYS.fusion, grid_res=16, points=500),
    )
    framed = replace(SEEN, points=SEEN.points / 4)
    found = told_by(replace(TOLD, surface=framed), 0.5, "fused")
    assert_same(found, fused(framed, POSED, ways, 7))
    assert len(found.points) == 500


def test_nothing_sure_is_an_empty_cloud():
    doubtful = witnesses.Testimony(
        torch.zeros(21),
        torch.full((21,), -1),
        Surface(*(v[:0] for v in vars(SEEN).values())),
        torch.zeros(1, 21),
    )
    for reading in ("confident", "surface", "fused"):
        found = told_by(doubtful, 0.0, reading)
        assert len(found.points) == len(found.view) == 0
