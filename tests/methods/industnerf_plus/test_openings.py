"""Plugged recesses are opened where the pictures show them, and nowhere else."""

from dataclasses import replace

import numpy as np
import pytest

from industnerf.config import load_params
from industnerf.methods.industnerf_plus import openings
from industnerf.methods.industnerf_plus.openings import open_recesses
from industnerf.methods.industnerf_plus.pictures import Pictures
from industnerf.methods.industnerf_plus.shaded_surface import PinholeRays, ShadedSurface

from .plugged_block import (
    BACKGROUND,
    BLOCK,
    CENTERED,
    DEPTH,
    POCKET,
    PX,
    SIZE,
    TOP,
    VIEWS,
    photographs,
    surface_of,
)

SETTINGS = load_params().method.industnerf_plus.openings


def opened(surface: ShadedSurface, pictures: Pictures) -> int:
    rays = PinholeRays(VIEWS, np.zeros(3), 1.0, surface.grid)
    return open_recesses(surface, rays, pictures, SETTINGS, seed=0)


@pytest.fixture(scope="module")
def pocket_pictures() -> Pictures:
    return photographs(np.maximum(BLOCK, -POCKET))


def test_a_plugged_pocket_is_opened_where_its_walls_are_seen(pocket_pictures):
    """Not to its floor, which looks as bright at any depth."""
    surface = surface_of(BLOCK)
    assert opened(surface, pocket_pictures) > 0
    distance = surface.distance.numpy()
    shaft = distance[28:30, 27:29].mean(axis=(0, 1))
    floor = np.flatnonzero(shaft < 0).max()
    crossing = floor + shaft[floor] / (shaft[floor] - shaft[floor + 1])
    depth = TOP + (SIZE - 1) / 2 - crossing
    assert DEPTH / 2 < depth < DEPTH + 1
    is_wrong = (distance > 0) != (np.maximum(BLOCK, -POCKET) > 0)
    assert is_wrong.sum() < 0.55 * (POCKET[BLOCK < 0] < 0).sum()
    is_solid = (BLOCK < -1) & (POCKET > 1)
    assert (distance[is_solid] < 0).mean() > 0.995
    assert (distance >= surface.grid.hull).all()


def test_a_wall_that_is_eaten_is_filled(pocket_pictures):
    bite = np.linalg.norm(CENTERED - (21.3, 0, 0), axis=-1) - 10
    surface = surface_of(np.maximum(np.maximum(BLOCK, -POCKET), -bite))
    assert opened(surface, pocket_pictures) > 0
    is_bitten = (bite < -1)[44]  # the last nodes under the face
    outermost = np.where(surface.distance.numpy() < 0, CENTERED[..., 0], -99).max(axis=0)
    assert (np.abs(outermost[is_bitten] - 16.5) < 1.5).mean() > 0.9


def test_nothing_is_opened_where_there_is_nothing():
    surface = surface_of(BLOCK)
    before = surface.distance.numpy().copy()
    assert opened(surface, photographs(BLOCK)) == 0
    np.testing.assert_array_equal(surface.distance.numpy(), before)


def test_several_finishes_tell_no_normal(pocket_pictures):
    assert opened(surface_of(BLOCK, finishes=2), pocket_pictures) == 0


def test_the_same_seed_opens_the_same(pocket_pictures):
    first, second = surface_of(BLOCK), surface_of(BLOCK)
    assert opened(first, pocket_pictures) == opened(second, pocket_pictures)
    np.testing.assert_array_equal(first.distance.numpy(), second.distance.numpy())


def test_a_plane_that_only_some_pixels_like_does_not_stay(monkeypatch, pocket_pictures):
    """One picture alone shows a pocket, and the pixels that are tried first are its own."""
    rgb = photographs(BLOCK).rgb.reshape(len(BACKGROUND), PX, PX, 3)
    view = int((VIEWS.centers @ [0, 0.1, 1]).argmax())
    order = [view, *(other for other in range(len(BACKGROUND)) if other != view)]
    rgb[view] = pocket_pictures.rgb.reshape(rgb.shape)[view]
    outlines = pocket_pictures._outlines.reshape(rgb.shape[:3])
    pictures = Pictures(rgb[order], BACKGROUND, outlines[order])
    surface = surface_of(BLOCK)
    before = surface.distance.numpy().copy()
    monkeypatch.setattr(openings, "every_nth", lambda values, most: values[:most])
    rays = PinholeRays(VIEWS[np.array(order)], np.zeros(3), 1.0, surface.grid)
    settings = replace(SETTINGS, rays_per_trial=20)
    assert open_recesses(surface, rays, pictures, settings, seed=0) == 0
    np.testing.assert_array_equal(surface.distance.numpy(), before)
