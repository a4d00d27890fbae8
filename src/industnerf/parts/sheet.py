"""Contact sheets: many parts on one picture."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float
from PIL import Image, ImageDraw, ImageFont

from industnerf.artifacts.finish import Finish
from industnerf.artifacts.part import Mesh
from industnerf.geometry.portrait import portrait

PICTURE_PX = 200
FONT_PX = 13
LINE_PX = 17
GAP_PX = 6  # between captions
LINES = 2  # of a caption
PAPER, INK, CROSS = "white", (40, 40, 40), (190, 70, 60)
UNCOLOURED = (0.62, 0.64, 0.67)  # of a finish that states no albedo


@dataclass(frozen=True)
class Tile:
    """One part of a contact sheet."""

    caption: str  # lines beyond LINES, and what is wider than the picture, are cut
    picture: Image.Image | None  # PICTURE_PX a side; None shows a crossed box


def tile_of(caption: str, mesh: Mesh, finishes: tuple[Finish, ...]) -> Tile:
    """A tile that shows `mesh`, whose `finish` counts `finishes`, and does not keep it."""
    return Tile(caption, _picture(mesh, finishes, PICTURE_PX))


def contact_sheet(tiles: Sequence[Tile], path: Path, columns: int) -> None:
    """Write the `tiles`, row by row in `columns` columns, to `path`, a PNG.

    Raises ValueError if there is no tile or no column.
    """
    if not tiles or columns < 1:
        raise ValueError(f"a contact sheet of {len(tiles)} tiles in {columns} columns")
    columns = min(columns, len(tiles))
    height = PICTURE_PX + LINES * LINE_PX + LINE_PX // 2
    rows = -(-len(tiles) // columns)
    sheet = Image.new("RGB", (columns * PICTURE_PX, rows * height), PAPER)
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(FONT_PX)
    for number, tile in enumerate(tiles):
        row, column = divmod(number, columns)
        _place(sheet, pen, font, tile, (column * PICTURE_PX, row * height))
    sheet.save(path)


def gallery(
    parts: Sequence[tuple[Mesh, tuple[Finish, ...]]], path: Path, columns: int, side_px: int
) -> None:
    """Write pictures without captions, `columns` in a row, to `path`, a PNG."""
    rows = -(-len(parts) // columns)
    sheet = Image.new("RGB", (columns * side_px, rows * side_px), PAPER)
    for number, (mesh, finishes) in enumerate(parts):
        row, column = divmod(number, columns)
        sheet.paste(_picture(mesh, finishes, side_px), (column * side_px, row * side_px))
    sheet.save(path)


def _picture(mesh: Mesh, finishes: tuple[Finish, ...], side_px: int) -> Image.Image:
    albedo = albedo_of(mesh, finishes)
    return Image.fromarray(portrait(mesh.vertices, mesh.faces, albedo, side_px))


def _place(
    sheet: Image.Image,
    pen: ImageDraw.ImageDraw,
    font: ImageFont.FreeTypeFont,
    tile: Tile,
    corner: tuple[int, int],
) -> None:
    left, top = corner
    if tile.picture is None:
        _crossed_box(pen, left, top)
    else:
        sheet.paste(tile.picture, corner)
    for number, line in enumerate(tile.caption.splitlines()[:LINES]):
        at = (left + PICTURE_PX // 2, top + PICTURE_PX + number * LINE_PX)
        pen.text(at, _fitting(line, font), INK, font, anchor="ma")


def _crossed_box(pen: ImageDraw.ImageDraw, left: int, top: int) -> None:
    inset = PICTURE_PX // 8
    low = (left + inset, top + inset)
    high = (left + PICTURE_PX - inset, top + PICTURE_PX - inset)
    pen.rectangle((low, high), outline=CROSS, width=2)
    pen.line((low, high), CROSS, 2)
    pen.line(((low[0], high[1]), (high[0], low[1])), CROSS, 2)


def _fitting(line: str, font: ImageFont.FreeTypeFont) -> str:
    """`line`, or as much of it as the picture is wide."""
    if font.getlength(line) <= PICTURE_PX - GAP_PX:
        return line
    while line and font.getlength(line + "…") > PICTURE_PX - GAP_PX:
        line = line[:-1]
    return line + "…"


def albedo_of(mesh: Mesh, finishes: tuple[Finish, ...]) -> Float[np.ndarray, "m 3"]:
    """The colour of every face, linear."""
    return np.array([finish.albedo or UNCOLOURED for finish in finishes])[mesh.finish]
