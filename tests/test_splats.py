"""Clouds as small pictures."""

import numpy as np
import pytest
from PIL import Image

from industnerf.errors import BadArtifact
from industnerf.geometry.sampling import sample_surface
from industnerf.splats import CORE_SHARE, core_box, preview, save_preview
from tests import solids

BALL = solids.ball(10.0)
POINTS = sample_surface(BALL.vertices, BALL.faces, 20_000, np.random.default_rng(0))[0]
SIZE = 120


def drawn(image):
    return (image != 255).any(axis=2)


def test_a_ball_is_a_disc_from_all_four_sides_and_as_large_as_the_tile():
    tiles = np.hsplit(preview(POINTS, None, SIZE), 4)
    for tile in tiles:
        # a disc that leaves 3 % on each side, and half a splat of 3 px
        assert drawn(tile).mean() == pytest.approx(np.pi * (0.47 + 1.5 / SIZE) ** 2, rel=0.03)
        corners = tile[[0, 0, -1, -1], [0, -1, 0, -1]]
        assert (corners == 255).all()


def test_strays_do_not_shrink_the_picture():
    """A hundred times as far as the ball is wide."""
    strays = np.vstack([POINTS, [[2000.0, 0, 0]] * 5])
    plain, with_strays = preview(POINTS, None, SIZE), preview(strays, None, SIZE)
    assert drawn(with_strays).mean() == pytest.approx(drawn(plain).mean(), rel=0.02)
    low, high = core_box(strays)
    assert (low, high) == (pytest.approx([-10] * 3, abs=0.1), pytest.approx([10] * 3, abs=0.1))
    assert 1 - 5 / len(strays) > CORE_SHARE


def test_what_is_nearer_hides_what_is_behind_it():
    """The half that the first camera sees is red; it stands at (1, -1.2, 0.9)."""
    towards = POINTS @ np.array([1.0, -1.2, 0.9]) > 0
    colors = np.where(towards[:, None], [200, 0, 0], [0, 0, 200]).astype(np.uint8)
    front, back = np.hsplit(preview(POINTS, colors, SIZE), 4)[:2]
    inner = np.s_[SIZE // 4 : -SIZE // 4, SIZE // 4 : -SIZE // 4]
    assert (front[inner][..., 2] == 0).mean() > 0.99
    assert (back[inner][..., 0] == 0).mean() > 0.4  # the second looks from (-1, 1.2, 0.9)


@pytest.mark.parametrize("count", [1, 2, 300])
def test_few_points_make_a_picture_too(count):
    assert drawn(preview(POINTS[:count], None, SIZE)).any()


def test_a_picture_is_written_or_the_folder_is_named(tmp_path):
    save_preview(tmp_path / "a.ply.png", POINTS, None)
    with Image.open(tmp_path / "a.ply.png") as image:
        assert image.size == (1440, 360)
    with pytest.raises(BadArtifact, match="nowhere"):
        save_preview(tmp_path / "nowhere" / "a.png", POINTS, None)
