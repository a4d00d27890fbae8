"""What is probably a slip is said, and nothing of what is probably none."""

import json

import numpy as np
import pytest
from PIL import Image

from industnerf.reconstruct.load_images import load_images
from tests.reconstruct import sample_images

BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)


@pytest.fixture
def folder(tmp_path):
    """Photographs of noise, amid a border of one pixel of white."""
    sample_images.write_image_set(tmp_path)
    for i, pixels in enumerate(sample_images.images()):
        framed = np.full_like(pixels, 255)
        framed[1:-1, 1:-1] = pixels[1:-1, 1:-1]
        save_image(tmp_path, i, framed)
    return tmp_path


def save_image(folder, i, pixels):
    Image.fromarray(pixels).save(folder / f"rgb/{i:03d}.png")


def warnings_of(folder, **options):
    return load_images(folder / "transforms.json", None, max_size=512, **options).warnings


def test_a_background_that_the_border_does_not_have_is_warned_of(folder):
    assert warnings_of(folder, background=WHITE) == ()
    assert warnings_of(folder) == ()
    assert warnings_of(folder, background=BLACK) == (
        "5 of 5 photographs have a border unlike --background #000000, in the median #ffffff: "
        "give the color behind the part, or leave --background out",
    )


def test_a_part_may_reach_over_less_than_half_of_the_border(folder):
    """Of 48 x 32 px 156 are at an edge."""
    pixels = np.full((sample_images.HEIGHT, sample_images.WIDTH, 3), 255, np.uint8)
    pixels[0], pixels[1:31, 0] = 0, 0  # 78
    save_image(folder, 2, pixels)
    assert warnings_of(folder, background=WHITE) == ()
    pixels[31, 0] = 0
    save_image(folder, 2, pixels)
    (warning,) = warnings_of(folder, background=WHITE)
    assert warning.startswith("1 of 5 photographs have a border unlike --background #ffffff, in ")


def test_light_may_fall_off(folder):
    for level, num_warnings in ((224, 0), (223, 1)):  # an eighth of 255 is 31.9
        save_image(
            folder, 0, np.full((sample_images.HEIGHT, sample_images.WIDTH, 3), level, np.uint8)
        )
        assert len(warnings_of(folder, background=WHITE)) == num_warnings


def test_what_is_see_through_has_the_background_that_is_given(folder):
    """Its color beneath may be anything."""
    clear = np.full((sample_images.HEIGHT, sample_images.WIDTH, 4), 255, np.uint8)
    clear[1:-1, 1:-1, :3] = sample_images.images()[0][1:-1, 1:-1]
    clear[0, :, 3] = clear[-1, :, 3] = clear[:, 0, 3] = clear[:, -1, 3] = 0
    for i in range(5):
        save_image(folder, i, clear)
    assert warnings_of(folder, background=BLACK) == (
        "5 of 5 photographs are see-through: shown over #000000",
    )


@pytest.mark.parametrize(("degrees", "num_warnings"), [(0.99, 1), (1.01, 0), (119, 0), (121, 1)])
def test_a_field_of_view_that_few_lenses_have_is_warned_of(folder, degrees, num_warnings):
    path = folder / "transforms.json"
    content = json.loads(path.read_text())
    del content["fl_y"]
    content["frames"][3]["fl_x"] = sample_images.WIDTH / 2 / np.tan(np.radians(degrees) / 2)
    sample_images.write_json_file(path, content)
    warnings = warnings_of(folder)
    assert len(warnings) == num_warnings
    for warning in warnings:
        assert warning.startswith(
            "1 of 5 photographs have a field of view above 120 or below 1 deg"
        )
        assert f"the first of {degrees:g}: are fl_x and fl_y in px, not in mm" in warning


def test_the_larger_of_two_fields_of_view_counts(folder):
    path = folder / "transforms.json"
    content = json.loads(path.read_text())
    sample_images.write_json_file(
        path, content | {"fl_y": 1.0}
    )  # 32 px high: 2 atan(16) is 173 degrees
    (warning,) = warnings_of(folder)
    assert "5 of 5 photographs" in warning
    assert "the first of 173:" in warning


def test_12_bits_in_16_are_all_but_black(folder):
    """4095 / 65535 of 255 is 15.9."""
    deep = np.full((sample_images.HEIGHT, sample_images.WIDTH), 4095, np.uint16)
    for i in (1, 2):
        save_image(folder, i, deep // i)
    save_image(
        folder, 3, np.full((sample_images.HEIGHT, sample_images.WIDTH), 8224, np.uint16)
    )  # 32 * 257
    assert warnings_of(folder) == (
        "2 of 5 photographs are all but black, with no value above 16 of 255; so look 12-bit "
        "values in 16-bit files: multiply those by 16",
    )
