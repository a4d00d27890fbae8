"""Photographs of different sizes and lenses: one window of each, and every ray where it was."""

import json

import numpy as np
import pytest
from PIL import Image

from industnerf.geometry.cameras import project
from industnerf.reconstruct.load_images import load_images
from tests.reconstruct import sample_images

CAMERAS = sample_images.cameras()
CENTER = sample_images.CENTER
POINTS = CENTER + np.random.default_rng(0).uniform(-0.5, 0.5, (20, 3))
PORTRAIT, LANDSCAPE = (40, 64), (64, 40)  # width, height in px
COLORS = np.random.default_rng(2).integers(0, 256, (64, 64, 3), np.uint8)


def write_two_sizes(folder, sizes, focal=60.0):
    """Photographs of `sizes` in turn, each with its own intrinsics; pixels say where they are."""
    path = sample_images.write_image_set(folder)
    content = json.loads(path.read_text())
    shared = ("fl_x", "fl_y", "cx", "cy", "w", "h")
    content = {key: value for key, value in content.items() if key not in shared}
    for i, frame in enumerate(content["frames"]):
        width, height = sizes[i % len(sizes)]
        frame |= {"fl_x": focal + i, "fl_y": focal + i, "w": width, "h": height}
        frame |= {"cx": width / 2, "cy": height / 2}
        Image.fromarray(COLORS[:height, :width]).save(folder / f"rgb/{i:03d}.png")
    return sample_images.write_json_file(path, content)


def load(path, **options):
    return load_images(path, None, max_size=512, **options)


def test_sizes_and_lenses_may_differ(tmp_path):
    """Each window shows the pixels that the whole photograph shows of the same points."""
    image_set = load(write_two_sizes(tmp_path, [PORTRAIT, LANDSCAPE]))
    assert len({*image_set.rgb.shape[1:3]}) == 1
    assert "photographs have 2 sizes" in image_set.warnings[-1]
    for i, (K, c2w, image) in enumerate(
        zip(image_set.cameras.K, image_set.cameras.c2w, image_set.rgb, strict=True)
    ):
        width, height = (PORTRAIT, LANDSCAPE)[i % 2]
        whole_K = np.array([[60.0 + i, 0, width / 2], [0, 60.0 + i, height / 2], [0, 0, 1]])
        before, _ = project(POINTS, whole_K, CAMERAS.c2w[i])
        after, _ = project(POINTS, K, c2w)
        shift = np.rint(before - after)
        np.testing.assert_allclose(
            before - after, shift, atol=1e-9
        )  # whole pixels: none is blurred
        for (u, v), (left, top) in zip(after.astype(int), shift.astype(int), strict=True):
            np.testing.assert_array_equal(image[v, u], COLORS[v + top, u + left])


def test_the_region_is_what_all_photographs_frame(tmp_path):
    """The narrow side of each is 40 px: no more fits at its focal length of 60 and above."""
    image_set = load(write_two_sizes(tmp_path, [PORTRAIT, LANDSCAPE]))
    np.testing.assert_allclose(image_set.center, CENTER, atol=1e-9)
    assert image_set.radius == pytest.approx(7 * np.sin(np.arctan(20 / 64)), rel=1e-9)


def test_what_lies_beyond_a_photograph_is_background(tmp_path):
    """A region that the user makes larger than the photographs."""
    path = write_two_sizes(tmp_path, [PORTRAIT, LANDSCAPE])
    image_set = load(path, background=(0.0, 0.0, 1.0), radius=4.0)
    assert image_set.rgb.shape[1:3] == (64, 64)
    assert (image_set.rgb[0, :, :11] == [0, 0, 255]).all()  # 40 of 64 columns are the photograph's
    np.testing.assert_array_equal(image_set.rgb[0, :, 12:52], COLORS[:64, :40])
    guessed = load(path, radius=4.0).rgb[0, :, :11]
    assert (guessed == guessed[0, 0]).all()


def test_one_size_is_left_as_it_is(tmp_path):
    image_set = load(write_two_sizes(tmp_path, [LANDSCAPE]))
    np.testing.assert_array_equal(image_set.rgb[0], COLORS[:40, :64])
    assert image_set.warnings == ()
