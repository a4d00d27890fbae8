"""Contact sheets: every part has its place."""

from itertools import pairwise

import numpy as np
import pytest
from PIL import Image

from industnerf.artifacts.finish import UNSTATED, Finish
from industnerf.parts.sheet import (
    CROSS,
    LINE_PX,
    LINES,
    PICTURE_PX,
    UNCOLOURED,
    Tile,
    albedo_of,
    contact_sheet,
    gallery,
    tile_of,
)
from tests.solids import ball, box

RED = Finish("red paint", (0.6, 0.05, 0.05), 0.0, 0.4)
HEIGHT = PICTURE_PX + LINES * LINE_PX + LINE_PX // 2


def drawn(tmp_path, *tiles, columns=2):
    path = tmp_path / "sheet.png"
    contact_sheet(tiles, path, columns)
    return np.asarray(Image.open(path))


def test_tiles_stand_row_by_row(tmp_path):
    tiles = [
        tile_of("ball", ball(10), (RED,)),
        Tile("no\nfile", None),
        tile_of("", box(1, 2, 3), (RED,)),
    ]
    sheet = drawn(tmp_path, *tiles)
    assert sheet.shape == (2 * HEIGHT, 2 * PICTURE_PX, 3)
    first, second = sheet[:PICTURE_PX, :PICTURE_PX], sheet[:PICTURE_PX, PICTURE_PX:]
    red = (first[..., 0] > 100) & (first[..., 2] < 100)
    assert red.mean() > 0.5
    assert tuple(second[PICTURE_PX // 2, PICTURE_PX // 2]) == CROSS
    assert not ((second[..., 0] < 150) & (second[..., 2] < 60)).any()
    assert (sheet[HEIGHT:, :PICTURE_PX] < 255).any()
    assert (sheet[HEIGHT:, PICTURE_PX:] == 255).all()  # nothing stands in the fourth place


def test_a_caption_has_two_lines_and_keeps_to_its_tile(tmp_path):
    wide = "x" * 200
    sheet = drawn(tmp_path, Tile(f"{wide}\nsecond\nthird", None), Tile("", None))
    rows = [PICTURE_PX + i * LINE_PX for i in range(LINES + 1)]
    for top, bottom in pairwise(rows):
        assert (sheet[top:bottom, :PICTURE_PX] < 100).any()
    assert (sheet[PICTURE_PX:, PICTURE_PX:] == 255).all()


def test_few_tiles_make_a_narrow_sheet(tmp_path):
    assert drawn(tmp_path, Tile("a", None), columns=9).shape[1] == PICTURE_PX


def test_a_name_that_no_font_draws_is_no_error(tmp_path):
    drawn(tmp_path, Tile("bad \udcff name", None), Tile("", None))


def test_equal_tiles_give_equal_bytes(tmp_path):
    tiles = [tile_of("ball", ball(10), (RED,))]
    for name in ("a.png", "b.png"):
        contact_sheet(tiles, tmp_path / name, 1)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_faces_have_the_colour_of_their_finish():
    mesh = box(1, 2, 3)
    mesh.finish[4:] = 1
    albedo = albedo_of(mesh, (RED, UNSTATED))
    np.testing.assert_array_equal(albedo[:4], [RED.albedo] * 4)
    np.testing.assert_array_equal(albedo[4:], [UNCOLOURED] * 8)


@pytest.mark.parametrize(("tiles", "columns"), [([], 3), ([Tile("a", None)], 0)])
def test_no_sheet_without_tiles_or_columns(tmp_path, tiles, columns):
    with pytest.raises(ValueError, match="contact sheet"):
        contact_sheet(tiles, tmp_path / "sheet.png", columns)


def test_a_gallery_has_pictures_alone_row_by_row(tmp_path):
    parts = [(ball(10), (RED,)), (ball(10), (UNSTATED,)), (box(1, 2, 3), (RED,))]
    gallery(parts, tmp_path / "gallery.png", columns=2, side_px=40)
    picture = np.asarray(Image.open(tmp_path / "gallery.png")).astype(int)
    assert picture.shape == (80, 80, 3)
    red = picture[..., 0] > picture[..., 2] + 60
    assert [red[20, 20], red[20, 60], red[60, 20]] == [True, False, True]
    assert (picture[40:, 40:] == 255).all()
