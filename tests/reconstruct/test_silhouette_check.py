"""A part that is as light as its background is warned of before it comes out eroded."""

from dataclasses import replace

import numpy as np
import pytest

from industnerf.artifacts.part import Appearance, save_part
from industnerf.artifacts.views import load_views
from industnerf.capture.render import render_part
from industnerf.config import load_params
from industnerf.reconstruct.silhouette_check import (
    Silhouettes,
    agree_once_transposed,
    lost_share,
    plain_silhouettes,
    silhouette_warning,
    transpose_rotations,
)
from tests.conftest import ROOT
from tests.samples import unit_part
from tests.solids import ball, box, transform_mesh, tube

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
    silhouettes = plain_silhouettes(rgb, views.cameras, colors)
    return silhouettes and silhouette_warning(silhouettes, CENTER, RADIUS)


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


NAMES = [f"rgb/{i:03d}.png" for i in range(10)]


def test_a_pose_that_contradicts_all_others_is_named(views_of_plate):
    """It has the part in frame: the camera was held upright and its photograph was turned."""
    cameras, masks = views_of_plate
    silhouettes = Silhouettes(masks, cameras, np.arange(10))
    assert silhouette_warning(silhouettes, CENTER, RADIUS, NAMES) is None
    turned = masks.copy()
    turned[6] = np.rot90(turned[6])
    moved = Silhouettes(turned, cameras, np.arange(10))
    warning = silhouette_warning(moved, CENTER, RADIUS, NAMES)
    assert warning.endswith(
        "it is rgb/006.png that contradicts all others: a wrong pose? Leave it out by "
        "--exclude rgb/006.png"
    )
    lost = masks.copy()
    lost[::2, :, :64] = False
    warning = silhouette_warning(Silhouettes(lost, cameras, np.arange(10)), CENTER, RADIUS, NAMES)
    assert WORDS in warning  # it is not one alone


def test_transposed_rotations_are_told(views_of_plate):
    """As in a COLMAP model whose quaternions are from camera to world; a ball would look alike."""
    cameras, masks = views_of_plate
    wrong = transpose_rotations(cameras.c2w)
    np.testing.assert_allclose(transpose_rotations(wrong), cameras.c2w, atol=1e-12)
    # the file: translations of world to camera, and rotations of camera to world
    for right, read in zip(cameras.c2w, wrong, strict=True):
        translation = -right[:3, :3].T @ right[:3, 3]
        np.testing.assert_allclose(-read[:3, :3].T @ read[:3, 3], translation, atol=1e-9)
    cases = ((replace(cameras, c2w=wrong), True), (cameras, False))
    for read_cameras, agrees in cases:
        assert agree_once_transposed(Silhouettes(masks, read_cameras, np.arange(10))) is agrees


@pytest.fixture
def views_of_plate(tmp_path):
    (tmp_path / "plate").mkdir()
    save_part(
        tmp_path / "plate", unit_part("plate"), transform_mesh(box(24.0, 14.0, 5.0), offset=CENTER)
    )
    settings = replace(
        load_params(ROOT / "params.yaml").views, count=10, held_out=0, resolution=128
    )
    render_part(tmp_path / "plate", tmp_path / "views", settings, 0)
    views = load_views(tmp_path / "views")
    return views.cameras, views.mask(np.arange(10))
