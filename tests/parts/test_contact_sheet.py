"""Contact sheets: every part has its place."""

from itertools import pairwise
from unicodedata import normalize

import numpy as np
import pytest
from PIL import Image

from industnerf.artifacts.part import UNSPECIFIED, Appearance
from industnerf.parts.contact_sheet import (
    CAPTION_LINES,
    CROSS_COLOR,
    DEFAULT_ALBEDO,
    LINE_PX,
    TILE_PX,
    Tile,
    caption_font,
    face_albedo,
    render_tile,
    write_contact_sheet,
    write_gallery,
)
from tests.solids import ball, box

RED = Appearance("red paint", (0.6, 0.05, 0.05), 0.0, 0.4)
HEIGHT = TILE_PX + CAPTION_LINES * LINE_PX + LINE_PX // 2


def draw_sheet(tmp_path, *tiles, columns=2):
    path = tmp_path / "sheet.png"
    write_contact_sheet(tiles, path, columns)
    return np.asarray(Image.open(path))


def test_tiles_stand_row_by_row(tmp_path):
    tiles = [
        render_tile("ball", ball(10), (RED,)),
        Tile("no\nfile", None),
        render_tile("", box(1, 2, 3), (RED,)),
    ]
    sheet = draw_sheet(tmp_path, *tiles)
    assert sheet.shape == (2 * HEIGHT, 2 * TILE_PX, 3)
    first, second = sheet[:TILE_PX, :TILE_PX], sheet[:TILE_PX, TILE_PX:]
    red = (first[..., 0] > 100) & (first[..., 2] < 100)
    assert red.mean() > 0.5
    assert tuple(second[TILE_PX // 2, TILE_PX // 2]) == CROSS_COLOR
    assert not ((second[..., 0] < 150) & (second[..., 2] < 60)).any()
    assert (sheet[HEIGHT:, :TILE_PX] < 255).any()
    assert (sheet[HEIGHT:, TILE_PX:] == 255).all()  # nothing stands in the fourth place


def test_a_caption_has_two_lines_and_keeps_to_its_tile(tmp_path):
    wide = "x" * 200
    sheet = draw_sheet(tmp_path, Tile(f"{wide}\nsecond\nthird", None), Tile("", None))
    rows = [TILE_PX + i * LINE_PX for i in range(CAPTION_LINES + 1)]
    for top, bottom in pairwise(rows):
        assert (sheet[top:bottom, :TILE_PX] < 100).any()
    assert (sheet[TILE_PX:, TILE_PX:] == 255).all()


@pytest.mark.parametrize("letter", ["ä", "ß", "é", "Ω", "ж", "a\u0308"])
def test_letters_beyond_ascii_are_no_boxes(letter, tmp_path):
    """Also where a file's name has them in two characters, as on a Mac."""
    font, composed = caption_font(letter), normalize("NFC", letter)
    missing = bytes(font.getmask("\ufffe"))
    assert bytes(font.getmask(composed)) != missing
    sheet = draw_sheet(tmp_path, Tile(letter, None), Tile(composed, None), columns=1)
    np.testing.assert_array_equal(sheet[TILE_PX:HEIGHT], sheet[HEIGHT + TILE_PX :])
    assert (sheet[TILE_PX:HEIGHT] < 255).any()


def test_few_tiles_make_a_narrow_sheet(tmp_path):
    assert draw_sheet(tmp_path, Tile("a", None), columns=9).shape[1] == TILE_PX


def test_a_name_that_no_font_draws_is_no_error(tmp_path):
    draw_sheet(tmp_path, Tile("bad \udcff name", None), Tile("", None))


def test_equal_tiles_give_equal_bytes(tmp_path):
    tiles = [render_tile("ball", ball(10), (RED,))]
    for name in ("a.png", "b.png"):
        write_contact_sheet(tiles, tmp_path / name, 1)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_faces_have_the_color_of_their_finish():
    mesh = box(1, 2, 3)
    mesh.finish[4:] = 1
    albedo = face_albedo(mesh, (RED, UNSPECIFIED))
    np.testing.assert_array_equal(albedo[:4], [RED.albedo] * 4)
    np.testing.assert_array_equal(albedo[4:], [DEFAULT_ALBEDO] * 8)


@pytest.mark.parametrize(("tiles", "columns"), [([], 3), ([Tile("a", None)], 0)])
def test_no_sheet_without_tiles_or_columns(tmp_path, tiles, columns):
    with pytest.raises(ValueError, match="contact sheet"):
        write_contact_sheet(tiles, tmp_path / "sheet.png", columns)


def test_a_gallery_has_pictures_alone_row_by_row(tmp_path):
    parts = [(ball(10), (RED,)), (ball(10), (UNSPECIFIED,)), (box(1, 2, 3), (RED,))]
    write_gallery(parts, tmp_path / "gallery.png", columns=2, side_px=40)
    image = np.asarray(Image.open(tmp_path / "gallery.png")).astype(int)
    assert image.shape == (80, 80, 3)
    red = image[..., 0] > image[..., 2] + 60
    assert [red[20, 20], red[20, 60], red[60, 20]] == [True, False, True]
    assert (image[40:, 40:] == 255).all()
