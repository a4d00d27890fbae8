"""What is probably a slip is said, and nothing of what is probably none."""

import json

import numpy as np
import pytest
from PIL import Image

from industnerf.reconstruct.gather import gather
from tests.reconstruct import scene

BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)


@pytest.fixture
def folder(tmp_path):
    """Photographs of noise, amid a border of one pixel of white."""
    scene.write(tmp_path)
    for i, pixels in enumerate(scene.photographs()):
        framed = np.full_like(pixels, 255)
        framed[1:-1, 1:-1] = pixels[1:-1, 1:-1]
        put(tmp_path, i, framed)
    return tmp_path


def put(folder, i, pixels):
    Image.fromarray(pixels).save(folder / f"rgb/{i:03d}.png")


def said(folder, **options):
    return gather(folder / "transforms.json", None, longest=512, **options).remarks


def test_a_background_that_the_border_does_not_have_is_doubted(folder):
    assert said(folder, background=WHITE) == ()
    assert said(folder) == ()
    assert said(folder, background=BLACK) == (
        "5 of 5 photographs have a border unlike --background #000000, in the median #ffffff: "
        "give the colour behind the part, or leave --background out",
    )


def test_a_part_may_reach_over_less_than_half_of_the_border(folder):
    """Of 48 x 32 px 156 are at an edge."""
    pixels = np.full((scene.HEIGHT, scene.WIDTH, 3), 255, np.uint8)
    pixels[0], pixels[1:31, 0] = 0, 0  # 78
    put(folder, 2, pixels)
    assert said(folder, background=WHITE) == ()
    pixels[31, 0] = 0
    put(folder, 2, pixels)
    (remark,) = said(folder, background=WHITE)
    assert remark.startswith("1 of 5 photographs have a border unlike --background #ffffff, in ")


def test_light_may_fall_off(folder):
    for level, doubted in ((224, 0), (223, 1)):  # an eighth of 255 is 31.9
        put(folder, 0, np.full((scene.HEIGHT, scene.WIDTH, 3), level, np.uint8))
        assert len(said(folder, background=WHITE)) == doubted


def test_what_is_see_through_has_the_background_that_is_given(folder):
    """Its colour beneath may be anything."""
    clear = np.full((scene.HEIGHT, scene.WIDTH, 4), 255, np.uint8)
    clear[1:-1, 1:-1, :3] = scene.photographs()[0][1:-1, 1:-1]
    clear[0, :, 3] = clear[-1, :, 3] = clear[:, 0, 3] = clear[:, -1, 3] = 0
    for i in range(5):
        put(folder, i, clear)
    assert said(folder, background=BLACK) == (
        "5 of 5 photographs are see-through: shown over #000000",
    )


@pytest.mark.parametrize(("degrees", "doubted"), [(0.99, 1), (1.01, 0), (119, 0), (121, 1)])
def test_a_field_of_view_that_few_lenses_have_is_doubted(folder, degrees, doubted):
    path = folder / "transforms.json"
    content = json.loads(path.read_text())
    del content["fl_y"]
    content["frames"][3]["fl_x"] = scene.WIDTH / 2 / np.tan(np.radians(degrees) / 2)
    scene.rewrite(path, content)
    remarks = said(folder)
    assert len(remarks) == doubted
    for remark in remarks:
        assert remark.startswith("1 of 5 photographs have a field of view above 120 or below 1 deg")
        assert f"the first of {degrees:g}: are fl_x and fl_y in px, not in mm" in remark


def test_the_larger_of_two_fields_of_view_counts(folder):
    path = folder / "transforms.json"
    content = json.loads(path.read_text())
    scene.rewrite(path, content | {"fl_y": 1.0})  # 32 px high: 2 atan(16) is 173 degrees
    (remark,) = said(folder)
    assert "5 of 5 photographs" in remark
    assert "the first of 173:" in remark


def test_12_bits_in_16_are_all_but_black(folder):
    """4095 / 65535 of 255 is 15.9."""
    deep = np.full((scene.HEIGHT, scene.WIDTH), 4095, np.uint16)
    for i in (1, 2):
        put(folder, i, deep // i)
    put(folder, 3, np.full((scene.HEIGHT, scene.WIDTH), 8224, np.uint16))  # 32 * 257
    assert said(folder) == (
        "2 of 5 photographs are all but black, with no value above 16 of 255; so look 12-bit "
        "values in 16-bit files: multiply those by 16",
    )
