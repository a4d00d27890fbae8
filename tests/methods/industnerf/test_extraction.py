"""From confidence to the cloud, by each reading."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from industnerf.config import load_params
from industnerf.methods.industnerf.confidence import (
    ObservedSurface,
    ViewConfidence,
    voxel_downsample,
)
from industnerf.methods.industnerf.extraction import extract_point_cloud, fuse_surface
from industnerf.methods.industnerf.scene import PosedImages
from tests.methods.solids import cameras_around

CAMERAS = cameras_around(5, 32, 1.0)
POSED = PosedImages(np.zeros((5, 32, 32, 3), np.uint8), CAMERAS, None, np.zeros(3), 1.0)
SETTINGS = load_params(Path(__file__).parents[3] / "params.yaml").method.industnerf


def random_surface(count: int, seed: int) -> ObservedSurface:
    generator = torch.Generator().manual_seed(seed)
    points, rgb = (torch.rand(count, 3, generator=generator) for _ in range(2))
    view = torch.randint(0, 5, (count,), generator=generator)
    return ObservedSurface(points, rgb, torch.linspace(0, 1, count), view)


POINTS, SURFACE = random_surface(21, 0), random_surface(41, 1)
CONFIDENCE = ViewConfidence(POINTS.confidence, POINTS.view, SURFACE, POINTS.confidence[None])


def extract(min_confidence: float, reading: str, spacing: float = 0.2) -> ObservedSurface:
    return extract_from(CONFIDENCE, min_confidence, reading, spacing)


def extract_from(
    view_confidence: ViewConfidence,
    min_confidence: float,
    reading: str,
    spacing: float = 0.2,
) -> ObservedSurface:
    config = replace(
        SETTINGS,
        surface_px=32,
        min_confidence=min_confidence,
        surface_spacing=spacing,
        fusion=replace(SETTINGS.fusion, grid_res=16, points=500),
    )
    return extract_point_cloud(
        POINTS.points, POINTS.rgb, view_confidence, POSED, config, reading, 7
    )


def assert_same(a: ObservedSurface, b: ObservedSurface) -> None:
    for name in vars(a):
        assert torch.equal(getattr(a, name), getattr(b, name)), name


@pytest.mark.parametrize(("min_confidence", "kept"), [(0.0, 20), (0.5, 11), (0.52, 10), (1.0, 1)])
def test_confident_points_are_the_clouds_own(min_confidence, kept):
    """The steps of confidence are 0.05; at the threshold a point stays, at 0 it never does."""
    actual = extract(min_confidence, "confident_points")
    assert len(actual.points) == kept
    assert_same(actual, ObservedSurface(*(values[-kept:] for values in vars(POINTS).values())))


@pytest.mark.parametrize(("min_confidence", "kept"), [(0.0, 41), (0.5, 21)])
def test_surface_points_are_those_of_sure_pixels_thinned(min_confidence, kept):
    rest = ObservedSurface(*(values[-kept:] for values in vars(SURFACE).values()))
    assert_same(extract(min_confidence, "surface_points"), voxel_downsample(rest, 0.2))
    fine = extract(min_confidence, "surface_points", 1e-4)
    assert len(fine.points) == kept


def test_fused_points_are_those_of_the_surface_that_the_views_agree_on():
    config = replace(
        SETTINGS,
        surface_px=32,
        min_confidence=0.5,
        fusion=replace(SETTINGS.fusion, grid_res=16, points=500),
    )
    scaled = replace(SURFACE, points=SURFACE.points / 4)
    actual = extract_from(replace(CONFIDENCE, surface=scaled), 0.5, "tsdf_fusion")
    assert_same(actual, fuse_surface(scaled, POSED, config, 7))
    assert len(actual.points) == 500


def test_nothing_sure_is_an_empty_cloud():
    no_confidence = ViewConfidence(
        torch.zeros(21),
        torch.full((21,), -1),
        ObservedSurface(*(v[:0] for v in vars(SURFACE).values())),
        torch.zeros(1, 21),
    )
    for reading in ("confident_points", "surface_points", "tsdf_fusion"):
        actual = extract_from(no_confidence, 0.0, reading)
        assert len(actual.points) == len(actual.view) == 0
