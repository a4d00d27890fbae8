"""The picture that MLflow shows of a method: photographs beside what was made of them."""

import numpy as np
import pytest

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.renderings import Renderings
from industnerf.artifacts.views import RgbdImage, Views, save_views
from industnerf.geometry.cameras import Cameras, look_at, pinhole
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.tracking import preview
from industnerf.tracking.preview import preview_image
from tests.archives import opened

SIDE = 8


@pytest.fixture
def study(tmp_path):
    """Ten parts photographed in a gray of their own and rendered lighter."""
    eyes = 300 * fibonacci_sphere(3)
    cameras = Cameras(
        np.tile(pinhole(35.0, SIDE), (3, 1, 1)), look_at(eyes, np.zeros(3)), SIDE, SIDE
    )
    flat = np.zeros((SIDE, SIDE))
    for i in range(10):
        held_out = np.array([False, True, True])
        views = Views(
            tmp_path / "views" / f"p{i}", f"p{i}", cameras, held_out, np.ones((3, 3)), 0.1, 1.0
        )
        grays = [np.full((SIDE, SIDE, 3), 10 * i + view, np.uint8) for view in range(3)]
        save_views(views, [RgbdImage(gray, flat > 0, flat.astype(np.float32)) for gray in grays])
        cloud = tmp_path / "clouds" / f"p{i}"
        cloud.mkdir(parents=True)
        renderings = np.stack(grays[1:]) + np.uint8(100)
        depth = np.zeros((2, SIDE, SIDE), np.float32)
        Renderings(renderings, depth, depth.astype(np.uint8)).save(cloud)
        origin_point = np.zeros((1, 3), np.float32)  # where every camera looks
        color, confidence = np.array([[200, 0, 0]], np.uint8), np.ones(1, np.float32)
        Cloud(f"p{i}", origin_point, color, confidence, np.zeros(1, np.int16), 0, 0).save(cloud)
    return tmp_path


def test_the_photograph_stands_beside_the_rendering_of_the_same_camera(study):
    image = preview_image(study / "clouds", study / "views")
    assert image.shape == (4 * SIDE, 2 * SIDE, 3)
    np.testing.assert_array_equal(image[::SIDE, 0, 0], [1, 31, 61, 91])
    np.testing.assert_array_equal(image[::SIDE, SIDE, 0], [101, 131, 161, 191])


def test_without_renderings_the_points_are_drawn(study):
    for folder in (study / "clouds").iterdir():
        (folder / "renderings.zip").unlink()
    image = preview_image(study / "clouds", study / "views")
    assert image.shape == (4 * SIDE, 2 * SIDE, 3)
    assert tuple(image[SIDE // 2, SIDE + SIDE // 2]) == (200, 0, 0)
    assert (image[0, SIDE] == 255).all()


def test_without_a_held_out_camera_there_is_no_picture(study):
    for archive in (study / "views").glob("*/photographs.zip"):
        with opened(archive) as folder:
            path = folder / "cameras.json"
            path.write_text(path.read_text().replace('"held_out": true', '"held_out": false'))
    assert preview_image(study / "clouds", study / "views") is None


def test_without_clouds_there_is_no_picture(study):
    assert preview_image(study / "views", study / "views") is None


def test_large_images_are_made_smaller(study, monkeypatch):
    monkeypatch.setattr(preview, "MAX_PREVIEW_PX", SIDE // 2)
    image = preview_image(study / "clouds", study / "views")
    assert image.shape == (4 * SIDE // 2, SIDE, 3)
    np.testing.assert_array_equal(image[:: SIDE // 2, 0, 0], [1, 31, 61, 91])
    np.testing.assert_array_equal(image[:: SIDE // 2, SIDE // 2, 0], [101, 131, 161, 191])
