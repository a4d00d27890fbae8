"""A part that is as light as its background is warned of before it comes out eroded."""

from dataclasses import replace

import numpy as np
import pytest

from industnerf.artifacts.part import Appearance, save_part
from industnerf.artifacts.views import load_views
from industnerf.capture.render import render_part
from industnerf.config import load_params
from industnerf.reconstruct.silhouette_check import lost_share, silhouette_warning
from tests.conftest import ROOT
from tests.samples import unit_part
from tests.solids import ball, transform_mesh, tube

CENTER, RADIUS = np.array([20.0, -30.0, 40.0]), 20.0
WORDS = "lies where another photograph shows the background: the part is as light as"


def warning_of(folder, albedo, background="white", *, known=True, spoil=lambda rgb: rgb):
    """What is said of the photographs of a ring of that albedo."""
    ring = transform_mesh(tube(6.0, 14.0, 10.0), offset=CENTER)
    finishes = (Appearance("paint", (albedo,) * 3, 0.0, 1.0),)
    (folder / "ring").mkdir()
    save_part(folder / "ring", unit_part("ring", finishes=finishes), ring)
    settings = replace(
        load_params(ROOT / "params.yaml").views,
        count=14,
        held_out=0,
        resolution=160,
        background=background,
    )
    render_part(folder / "ring", folder / "views", settings, 0)
    views = load_views(folder / "views")
    rgb, colors = spoil(views.rgb(np.arange(14))), views.background if known else None
    return silhouette_warning(rgb, views.cameras, colors, CENTER, RADIUS)


@pytest.mark.parametrize("known", [True, False])
def test_a_light_part_before_white_is_warned_of(tmp_path, known):
    assert WORDS in warning_of(tmp_path, 0.9, known=known)


@pytest.mark.parametrize(
    ("albedo", "background"), [(0.9, "black"), (0.5, "white"), (0.05, "white"), (0.6, "gray")]
)
def test_a_part_that_stands_out_is_not(tmp_path, albedo, background):
    assert warning_of(tmp_path, albedo, background) is None


def test_before_no_plain_background_nothing_is_known(tmp_path):
    noise = np.random.default_rng(0).integers(0, 256, (14, 160, 160, 3), np.uint8)
    assert warning_of(tmp_path, 0.9, spoil=lambda rgb: noise) is None


def test_exact_silhouettes_lose_nothing_and_gaps_are_lost(views_of_ball):
    cameras, masks = views_of_ball
    assert lost_share(masks, cameras, CENTER, RADIUS) == 0
    masks = masks.copy()
    masks[::2, :, :64] = False  # half of the ball is missing in every other photograph
    assert lost_share(masks, cameras, CENTER, RADIUS) > 0.1


@pytest.fixture
def views_of_ball(tmp_path):
    mesh = transform_mesh(ball(15.0), offset=CENTER)
    (tmp_path / "ball").mkdir()
    save_part(tmp_path / "ball", unit_part("ball"), mesh)
    settings = replace(
        load_params(ROOT / "params.yaml").views, count=10, held_out=0, resolution=128
    )
    render_part(tmp_path / "ball", tmp_path / "views", settings, 0)
    views = load_views(tmp_path / "views")
    return views.cameras, views.mask(np.arange(10))
