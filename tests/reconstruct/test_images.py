"""Photographs of every kind as 8-bit color."""

import numpy as np
import pytest
from PIL import Image

from industnerf.errors import BadArtifact
from industnerf.reconstruct.images import ImageInfo, composite, is_same_aspect, read_image

W, H = 6, 4
RGB = np.random.default_rng(1).integers(0, 256, (H, W, 3), np.uint8)
BLUE = np.array([0.0, 0.0, 1.0])


def load(path, camera_size=None):
    """Over blue, where it is see-through."""
    pixels, info = read_image(path, camera_size, "frame 3 (a)")
    return composite(pixels, BLUE), info


def save_image(tmp_path, pixels, name="a.png", **options):
    image = pixels if isinstance(pixels, Image.Image) else Image.fromarray(pixels)
    image.save(tmp_path / name, **options)
    return tmp_path / name


@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.bmp"])
def test_color_is_read_as_it_is(tmp_path, name):
    rgb, info = load(save_image(tmp_path, RGB, name))
    np.testing.assert_array_equal(rgb, RGB)
    assert info == ImageInfo((W, H), has_transparency=False, is_rotated=False)


def test_a_jpeg_is_read(tmp_path):
    flat = np.full((16, 16, 3), (200, 100, 50), np.uint8)
    rgb, _ = load(save_image(tmp_path, flat, "a.jpg", quality=95))
    assert np.abs(rgb.astype(int) - flat).max() <= 3  # a flat color is off by chroma's rounding


def test_gray_becomes_three_equal_channels(tmp_path):
    rgb, _ = load(save_image(tmp_path, RGB[..., 0]))
    np.testing.assert_array_equal(rgb, RGB[..., :1].repeat(3, axis=2))


def test_sixteen_bits_become_eight(tmp_path):
    """65535 is white as 255 is: v / 257, rounded, so that 8-bit levels times 257 come back."""
    deep = RGB[..., 0].astype(np.uint16) * 257
    rgb, _ = load(save_image(tmp_path, deep))
    np.testing.assert_array_equal(rgb[..., 1], RGB[..., 0])
    rgb, _ = load(save_image(tmp_path, np.full((2, 2), 129 + 257 * 7, np.uint16)))
    assert (rgb == 8).all()  # 129 is more than half of 257


def test_see_through_pixels_show_the_background(tmp_path):
    alpha = np.array([0, 51, 255], np.uint8)  # 51 is a fifth
    pixels = np.zeros((1, 3, 4), np.uint8)
    pixels[..., :3], pixels[..., 3] = (100, 200, 50), alpha
    rgb, info = load(save_image(tmp_path, pixels))
    assert info.has_transparency
    assert rgb[0].tolist() == [[0, 0, 255], [20, 40, 214], [100, 200, 50]]


def test_an_alpha_channel_that_hides_nothing_is_none(tmp_path):
    opaque = np.full((H, W, 1), 255, np.uint8)
    rgb, info = load(save_image(tmp_path, np.concatenate([RGB, opaque], axis=2)))
    np.testing.assert_array_equal(rgb, RGB)
    assert info == ImageInfo((W, H), has_transparency=False, is_rotated=False)


def test_a_palette_with_a_see_through_color_shows_the_background(tmp_path):
    image = Image.fromarray(np.array([[0, 1]], np.uint8)).convert("P")
    image.putpalette([9, 8, 7, 6, 5, 4])
    rgb, info = load(save_image(tmp_path, image, transparency=0))
    assert info.has_transparency
    assert rgb[0].tolist() == [[0, 0, 255], [6, 5, 4]]


def test_gray_with_alpha_is_see_through(tmp_path):
    pixels = np.array([[[10, 255], [10, 0]]], np.uint8)
    image = Image.merge("LA", [Image.fromarray(pixels[..., channel]) for channel in (0, 1)])
    rgb, info = load(save_image(tmp_path, image))
    assert info.has_transparency
    assert rgb[0].tolist() == [[10, 10, 10], [0, 0, 255]]


def with_orientation(tmp_path, orientation):
    exif = Image.Exif()
    exif[0x0112] = orientation
    return save_image(tmp_path, RGB, exif=exif)


@pytest.mark.parametrize("camera_size", [(W, H), (10 * W, 10 * H)])
def test_an_orientation_that_the_camera_ignores_is_ignored(tmp_path, camera_size):
    rgb, info = load(with_orientation(tmp_path, 6), camera_size)
    np.testing.assert_array_equal(rgb, RGB)
    assert info == ImageInfo((W, H), has_transparency=False, is_rotated=False)


def test_an_orientation_that_the_camera_follows_is_applied(tmp_path):
    """6: the camera was turned left, so the picture is turned clockwise to stand upright."""
    rgb, info = load(with_orientation(tmp_path, 6), (H, W))
    np.testing.assert_array_equal(rgb, np.rot90(RGB, -1))
    assert info == ImageInfo((H, W), has_transparency=False, is_rotated=True)


@pytest.mark.parametrize(
    ("orientation", "camera_size"), [(6, None), (3, (W, H)), (2, (W, H)), (8, (W, W))]
)
def test_an_orientation_that_could_be_either_is_refused(tmp_path, orientation, camera_size):
    with pytest.raises(BadArtifact, match=r"frame 3 \(a\): .*a.png has an EXIF orientation"):
        load(with_orientation(tmp_path, orientation), camera_size)


@pytest.mark.parametrize("orientation", [0, 1])
def test_an_upright_orientation_is_none(tmp_path, orientation):
    np.testing.assert_array_equal(load(with_orientation(tmp_path, orientation))[0], RGB)


def test_floats_are_refused(tmp_path):
    path = save_image(tmp_path, np.zeros((H, W), np.float32), "a.tif")
    with pytest.raises(BadArtifact, match=r"frame 3 \(a\): .*a.tif holds pixels of kind 'F'"):
        load(path)


@pytest.mark.parametrize("cut", [0, 20, 0.6])
def test_torn_files_are_refused(tmp_path, cut):
    path = save_image(tmp_path, RGB.repeat(20, axis=0).repeat(20, axis=1))
    data = path.read_bytes()
    path.write_bytes(data[: int(cut * len(data)) if cut < 1 else cut])
    with pytest.raises(BadArtifact, match=r"frame 3 \(a\): .*a.png cannot be read as an image"):
        load(path)


def test_text_and_nothing_are_refused(tmp_path):
    (tmp_path / "a.png").write_text("this is no image")
    for path in (tmp_path / "a.png", tmp_path / "none.png"):
        with pytest.raises(BadArtifact, match=f"{path.name} cannot be read as an image"):
            load(path)


@pytest.mark.parametrize(
    ("size", "same"),
    [
        ((4000, 3000), True),
        ((1000, 750), True),
        ((333, 250), True),  # 333.3 rounded
        ((8000, 6000), True),
        ((4000, 2999), False),  # a row was cut
        ((3000, 4000), False),
        ((1000, 740), False),
    ],
)
def test_scaled_is_told_from_cropped(size, same):
    assert is_same_aspect(size, (4000, 3000)) is same
