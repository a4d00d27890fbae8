"""Renderings: what is written is what is read, or an error that names the file."""

import io
import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from industnerf.artifacts.renderings import ARCHIVE, Renderings
from industnerf.errors import BadArtifact
from tests.archives import members, opened

COUNT, HIGH, WIDE = 3, 10, 14
FARTHEST = 700.0  # mm


@pytest.fixture
def renderings() -> Renderings:
    rng = np.random.default_rng(0)
    shape = (COUNT, HIGH, WIDE)
    opacity = rng.integers(0, 256, shape, np.uint8)
    depth = np.where(opacity > 60, rng.uniform(300, FARTHEST, shape), 0).astype(np.float32)
    return Renderings(rng.integers(0, 256, (*shape, 3), np.uint8), depth, opacity)


@pytest.fixture
def saved(renderings, tmp_path) -> Path:
    renderings.save(tmp_path)
    return tmp_path


def test_renderings_survive_their_files(renderings, saved):
    read = Renderings.load(saved)
    assert len(read) == COUNT
    np.testing.assert_array_equal(read.rgb, renderings.rgb)
    np.testing.assert_array_equal(read.opacity, renderings.opacity)
    # half a step of 16 bits up to the farthest, and the rounding of 700 mm in float32
    step = FARTHEST / 65535
    np.testing.assert_allclose(read.depth_mm, renderings.depth_mm, rtol=0, atol=step / 2 + 1e-4)
    np.testing.assert_array_equal(read.depth_mm > 0, renderings.depth_mm > 0)


def test_what_is_very_near_does_not_become_background(tmp_path):
    depth = np.array([[[0.0, 1e-3, FARTHEST]]], np.float32)
    Renderings(np.zeros((1, 1, 3, 3), np.uint8), depth, np.zeros((1, 1, 3), np.uint8)).save(
        tmp_path
    )
    np.testing.assert_array_equal(Renderings.load(tmp_path).depth_mm > 0, depth > 0)


@pytest.mark.parametrize("count", [0, 2])
def test_no_camera_or_nothing_in_sight_is_no_special_case(tmp_path, count):
    rgb = np.zeros((count, HIGH, WIDE, 3), np.uint8)
    blank = np.zeros((count, HIGH, WIDE), np.uint8)
    Renderings(rgb, blank.astype(np.float32), blank).save(tmp_path)
    read = Renderings.load(tmp_path)
    assert read.rgb.shape == rgb.shape
    assert not read.depth_mm.any()


def test_half_opaque_is_foreground():
    """As a method rounds it: 255 times the opacity, to the nearest level."""
    opacity = np.array([0.0, 0.49, 0.4999, 0.5, 0.51, 1.0])
    levels = np.rint(255 * opacity).astype(np.uint8)
    blank = np.zeros((1, 1, 6), np.float32)
    thresholded = Renderings(np.zeros((1, 1, 6, 3), np.uint8), blank, levels[None, None])
    np.testing.assert_array_equal(thresholded.foreground[0, 0], opacity >= 0.5)


def test_images_are_what_their_names_say(saved):
    """Read by pillow alone: 8-bit color, 16-bit depth, 8-bit opacity."""
    modes = {}
    for kind in ("rgb", "depth", "opacity"):
        png = members(saved / ARCHIVE)[f"{kind}/000.png"]
        with Image.open(io.BytesIO(png)) as image:
            modes[kind] = image.mode
            assert image.size == (WIDE, HIGH)
    assert modes == {"rgb": "RGB", "depth": "I;16", "opacity": "L"}


def test_equal_content_is_equal_bytes(renderings, saved, tmp_path_factory):
    again = tmp_path_factory.mktemp("again")
    renderings.save(again)
    assert len(members(saved / ARCHIVE)) == 1 + 3 * COUNT
    assert (saved / ARCHIVE).read_bytes() == (again / ARCHIVE).read_bytes()


def test_the_first_colors_are_read_alone(renderings, saved):
    np.testing.assert_array_equal(Renderings.load_first_rgb(saved), renderings.rgb[0])
    blank = np.zeros((0, HIGH, WIDE), np.uint8)
    no_views = Renderings(np.zeros((0, HIGH, WIDE, 3), np.uint8), blank.astype(np.float32), blank)
    no_views.save(saved)
    assert Renderings.load_first_rgb(saved) is None


def test_a_method_that_does_not_render_has_none(tmp_path):
    assert Renderings.load(tmp_path) is None
    assert Renderings.load_first_rgb(tmp_path) is None


@pytest.mark.parametrize("name", ["renderings.json", "rgb/000.png", "depth/001.png"])
@pytest.mark.parametrize("num_bytes", [None, 0, 40])
def test_a_missing_or_torn_file_is_named(saved, name, num_bytes):
    with opened(saved / ARCHIVE) as folder:
        path = folder / name
        content = path.read_bytes()
        path.unlink()
        if num_bytes is not None:
            path.write_bytes(content[:num_bytes])
    with pytest.raises(BadArtifact, match=rf"{name}.*dvc repro"):
        Renderings.load(saved)


def test_an_image_of_another_size_or_kind_is_refused(saved):
    with opened(saved / ARCHIVE) as folder:
        Image.new("L", (WIDE, HIGH + 1)).save(folder / "opacity/001.png")
    with pytest.raises(BadArtifact, match=r"opacity/001\.png has \(11, 14\) rows and columns"):
        Renderings.load(saved)
    with opened(saved / ARCHIVE) as folder:
        Image.new("RGB", (WIDE, HIGH)).save(folder / "opacity/001.png")
    with pytest.raises(BadArtifact, match=r"opacity/001\.png holds uint8 in \(3,\) channels"):
        Renderings.load(saved)


def test_another_schema_is_refused(saved):
    with opened(saved / ARCHIVE) as folder:
        path = folder / "renderings.json"
        path.write_text(json.dumps(json.loads(path.read_text()) | {"schema": 99}))
    with pytest.raises(BadArtifact, match="schema 99, this code reads 1"):
        Renderings.load(saved)
