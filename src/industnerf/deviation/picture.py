"""A deviation map as a picture: the cloud from four sides, a title, and a color bar in mm."""

import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image, ImageDraw, ImageFont

from industnerf.report.html.cloud_page import ALL_COLOR_MAPS
from industnerf.report.html.viewer import color_map
from industnerf.splats import preview

WHITE, INK = (255, 255, 255), (31, 35, 40)
FONT_PX, LINE_PX = 16, 24
BAR_PX = 14  # height of the color bar
BAR_SHARE = 0.5  # of the picture's width
TICK_PX = 5
MAX_TITLE_SHARE = 0.98  # of the width; a longer title gets a smaller font


def deviation_colors(deviation: Float[np.ndarray, "n"], end_mm: float) -> UInt8[np.ndarray, "n 3"]:
    """Blue at -`end_mm` and beyond, gray at 0, red at `end_mm` and beyond."""
    share = np.clip(0.5 + deviation / (2 * end_mm), 0, 1)
    return color_map(ALL_COLOR_MAPS["deviation"])[np.rint(255 * share).astype(int)]


def deviation_picture(
    points: Float[np.ndarray, "n 3"],
    deviation: Float[np.ndarray, "n"],
    end_mm: float,
    tolerance_mm: float,
    title: str,
) -> UInt8[np.ndarray, "h w 3"]:
    """The points from four sides, colored up to `end_mm`, with title and color bar.

    The bar has ticks at its ends, at 0 and at the tolerance on either side.
    """
    views = preview(points, deviation_colors(deviation, end_mm))
    height, width = views.shape[:2]
    image = Image.new("RGB", (width, LINE_PX + height + BAR_PX + TICK_PX + 2 * LINE_PX), WHITE)
    _draw_line(image, title, 0)
    image.paste(Image.fromarray(views), (0, LINE_PX))
    _draw_bar(image, LINE_PX + height, end_mm, tolerance_mm)
    caption = (
        "deviation: blue inside the CAD surface, red outside it; "
        f"tolerance {tolerance_mm:g} mm on either side"
    )
    _draw_line(image, caption, image.height - LINE_PX)
    return np.asarray(image)


def _draw_line(image: Image.Image, text: str, top: int) -> None:
    """A centered line, in a font that fits into the picture."""
    fonts = map(ImageFont.load_default, range(FONT_PX, 0, -1))
    font = next(font for font in fonts if font.getlength(text) < MAX_TITLE_SHARE * image.width)
    middle = (image.width / 2, top + LINE_PX / 2)
    ImageDraw.Draw(image).text(middle, text, fill=INK, font=font, anchor="mm")


def _draw_bar(image: Image.Image, top: int, end_mm: float, tolerance_mm: float) -> None:
    bar_width = round(BAR_SHARE * image.width)
    left = (image.width - bar_width) // 2
    row = deviation_colors(np.linspace(-end_mm, end_mm, bar_width), end_mm)
    image.paste(Image.fromarray(np.tile(row, (BAR_PX, 1, 1))), (left, top))
    draw = ImageDraw.Draw(image)
    ticks = {-end_mm, -tolerance_mm, 0.0, tolerance_mm, end_mm}
    font = ImageFont.load_default(FONT_PX)
    taken = -np.inf
    for value in sorted(tick for tick in ticks if abs(tick) <= end_mm):
        x = left + (value + end_mm) / (2 * end_mm) * (bar_width - 1)
        draw.line([(x, top), (x, top + BAR_PX + TICK_PX)], fill=INK)
        text = f"{value:+.3g} mm" if value else "0"
        half = font.getlength(text) / 2
        if x - half > taken:  # at 20 tolerances those have no room beside 0
            draw.text((x, top + BAR_PX + TICK_PX), text, fill=INK, font=font, anchor="ma")
            taken = x + half
