"""Pictures for a repository: small, and still the same picture."""

import io

import numpy as np
import pytest
from PIL import Image

from industnerf.report.publish.study_folder import IMAGE_WIDTHS, downsample_png


def png(pixels: np.ndarray) -> bytes:
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, "PNG")
    return out.getvalue()


def open_png(data):
    picture = Image.open(io.BytesIO(data))
    picture.load()
    return picture


@pytest.fixture(scope="module")
def noise():
    """Grays that nothing compresses: its size follows its area."""
    gray = np.random.default_rng(0).integers(0, 256, (100, 2400, 1), np.uint8)
    return png(np.repeat(gray, 3, axis=2))


def test_a_picture_of_few_colors_stays_as_it_is():
    pixels = np.zeros((40, 60, 3), np.uint8)
    pixels[:20, :30], pixels[20:, 30:] = (200, 30, 10), (0, 120, 255)
    small = open_png(downsample_png(png(pixels), 10**6))
    assert small.mode == "P"
    assert np.array_equal(np.asarray(small.convert("RGB")), pixels)


def test_it_is_as_wide_as_the_budget_allows(noise):
    wide, narrow = downsample_png(noise, 10**6), downsample_png(noise, 100_000)
    assert open_png(wide).size == (IMAGE_WIDTHS[0], round(100 * IMAGE_WIDTHS[0] / 2400))
    assert len(narrow) <= 100_000
    width = open_png(narrow).width
    assert width < IMAGE_WIDTHS[0]
    wider = IMAGE_WIDTHS[IMAGE_WIDTHS.index(width) - 1]
    # one step wider has too many bytes: at least 0.8 a pixel, as many as 100 equally likely grays
    assert 0.8 * wider * (100 * wider // 2400) > 100_000


def test_the_narrowest_is_returned_however_large(noise):
    assert open_png(downsample_png(noise, 1)).width == IMAGE_WIDTHS[-1]
