"""Contact sheets: many parts on one picture."""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from unicodedata import normalize

import numpy as np
from jaxtyping import Float
from PIL import Image, ImageDraw, ImageFont

from industnerf.artifacts.part import Appearance, Mesh
from industnerf.geometry.thumbnail import render_thumbnail

TILE_PX = 200
FONT_PX = 13
WIDE_FONT_PX = 12  # of the font for letters beyond ASCII, which is wider
LINE_PX = 17
GAP_PX = 6  # between captions
CAPTION_LINES = 2  # of a caption
BACKGROUND_COLOR, TEXT_COLOR, CROSS_COLOR = "white", (40, 40, 40), (190, 70, 60)
DEFAULT_ALBEDO = (0.62, 0.64, 0.67)  # of a finish that states no albedo


@dataclass(frozen=True)
class Tile:
    """One part of a contact sheet."""

    caption: str  # lines beyond CAPTION_LINES, and what is wider than a tile, are cut
    image: Image.Image | None  # TILE_PX a side; None shows a crossed box


def render_tile(caption: str, mesh: Mesh, finishes: tuple[Appearance, ...]) -> Tile:
    """A tile that shows `mesh`, whose faces index `finishes`; the mesh is not kept."""
    return Tile(caption, _render(mesh, finishes, TILE_PX))


def write_contact_sheet(tiles: Sequence[Tile], path: Path, columns: int) -> None:
    """Write the `tiles`, row by row in `columns` columns, to `path`, a PNG.

    Raises ValueError if there is no tile or no column.
    """
    if not tiles or columns < 1:
        raise ValueError(f"a contact sheet of {len(tiles)} tiles in {columns} columns")
    columns = min(columns, len(tiles))
    height = TILE_PX + CAPTION_LINES * LINE_PX + LINE_PX // 2
    rows = -(-len(tiles) // columns)
    sheet = Image.new("RGB", (columns * TILE_PX, rows * height), BACKGROUND_COLOR)
    pen = ImageDraw.Draw(sheet)
    for number, tile in enumerate(tiles):
        row, column = divmod(number, columns)
        _draw_tile(sheet, pen, tile, (column * TILE_PX, row * height))
    sheet.save(path)


def write_gallery(
    parts: Sequence[tuple[Mesh, tuple[Appearance, ...]]], path: Path, columns: int, side_px: int
) -> None:
    """Write pictures without captions, `columns` in a row, to `path`, a PNG."""
    rows = -(-len(parts) // columns)
    sheet = Image.new("RGB", (columns * side_px, rows * side_px), BACKGROUND_COLOR)
    for number, (mesh, finishes) in enumerate(parts):
        row, column = divmod(number, columns)
        sheet.paste(_render(mesh, finishes, side_px), (column * side_px, row * side_px))
    sheet.save(path)


def _render(mesh: Mesh, finishes: tuple[Appearance, ...], side_px: int) -> Image.Image:
    albedo = face_albedo(mesh, finishes)
    return Image.fromarray(render_thumbnail(mesh.vertices, mesh.faces, albedo, side_px))


def _draw_tile(
    sheet: Image.Image,
    pen: ImageDraw.ImageDraw,
    tile: Tile,
    corner: tuple[int, int],
) -> None:
    left, top = corner
    if tile.image is None:
        _draw_crossed_box(pen, left, top)
    else:
        sheet.paste(tile.image, corner)
    for number, line in enumerate(tile.caption.splitlines()[:CAPTION_LINES]):
        anchor = (left + TILE_PX // 2, top + TILE_PX + number * LINE_PX)
        font, composed = caption_font(line), normalize("NFC", line)
        pen.text(anchor, _truncate(composed, font), TEXT_COLOR, font, anchor="ma")


def caption_font(text: str) -> ImageFont.FreeTypeFont:
    """A font that has the letters of `text`: Pillow's own has those of ASCII alone."""
    package = find_spec("matplotlib")  # for its font files; it is not imported
    if text.isascii() or package is None or package.origin is None:
        return ImageFont.load_default(FONT_PX)
    path = Path(package.origin).parent / "mpl-data" / "fonts" / "ttf" / "DejaVuSans.ttf"
    return ImageFont.truetype(path, WIDE_FONT_PX) if path.exists() else caption_font("")


def _draw_crossed_box(pen: ImageDraw.ImageDraw, left: int, top: int) -> None:
    inset = TILE_PX // 8
    low = (left + inset, top + inset)
    high = (left + TILE_PX - inset, top + TILE_PX - inset)
    pen.rectangle((low, high), outline=CROSS_COLOR, width=2)
    pen.line((low, high), CROSS_COLOR, 2)
    pen.line(((low[0], high[1]), (high[0], low[1])), CROSS_COLOR, 2)


def _truncate(line: str, font: ImageFont.FreeTypeFont) -> str:
    """`line`, or as much of it as the picture is wide."""
    if font.getlength(line) <= TILE_PX - GAP_PX:
        return line
    while line and font.getlength(line + "…") > TILE_PX - GAP_PX:
        line = line[:-1]
    return line + "…"


def face_albedo(mesh: Mesh, finishes: tuple[Appearance, ...]) -> Float[np.ndarray, "m 3"]:
    """The color of every face, linear."""
    return np.array([finish.albedo or DEFAULT_ALBEDO for finish in finishes])[mesh.finish]
