"""Held-out photographs stand beside the renderings of the same cameras."""

import io

import numpy as np
import pytest
from PIL import Image

from industnerf.artifacts.renderings import Renderings
from industnerf.artifacts.views import RgbdImage, Views, save_views
from industnerf.geometry.cameras import Cameras, look_at, pinhole
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.report.figures.held_out_renderings import (
    MAX_SIDE_PX,
    load_held_out_renderings,
    load_part_images,
)
from industnerf.report.html.page import environment
from tests.report import ball_study

PX = 2 * MAX_SIDE_PX


def mean_gray(content: bytes) -> float:
    return float(np.asarray(Image.open(io.BytesIO(content))).mean())


@pytest.fixture
def rendered_study(tmp_path):
    """Views 1, 2 and 3 of four are held out: 10, 20 and 30; renderings are 100 lighter."""
    eyes = 300 * fibonacci_sphere(4)
    K = np.tile(pinhole(35.0, PX), (4, 1, 1))
    cameras = Cameras(K, look_at(eyes, np.zeros(3)), PX, PX)
    flat, tones = np.zeros((PX, PX)), [np.full((PX, PX, 3), 10 * i, np.uint8) for i in range(4)]
    for name in ball_study.PARTS:
        ball_study.write_part(tmp_path, name)
        folder = tmp_path / "nowhere" / name
        held_out = np.array([False, True, True, True])
        views = Views(folder, name, cameras, held_out, np.ones((4, 3)), 0.1, 1.0)
        save_views(views, [RgbdImage(tone, flat > 0, flat.astype(np.float32)) for tone in tones])
    depth = np.zeros((3, PX, PX), np.float32)
    hull_renderings = Renderings(np.stack(tones[1:]) + np.uint8(100), depth, depth.astype(np.uint8))
    hull_renderings.save(tmp_path / "hull" / "near-ball")
    return ball_study.study(tmp_path)


def test_each_photograph_has_the_answer_of_its_own_camera(rendered_study):
    held_out = load_held_out_renderings(rendered_study, list(rendered_study.parts.values()))
    assert held_out.methods == ["hull"]
    (near, pictures), (failed_part, failed_images) = held_out.rows
    assert (near.part_id, failed_part.part_id) == ball_study.PARTS
    tones = [[mean_gray(content) for content in view] for view in pictures]
    np.testing.assert_allclose(tones, [[10, 110], [30, 130]], atol=1)  # the first and the last
    assert [view[1] for view in failed_images] == [None, None]
    assert Image.open(io.BytesIO(pictures[0][0])).size == (MAX_SIDE_PX, MAX_SIDE_PX)


def section(renderings) -> str:
    return environment().get_template("sections.html.j2").module.held_out_views(renderings)


def test_on_the_page_what_failed_says_so(rendered_study):
    renderings = load_held_out_renderings(rendered_study, list(rendered_study.parts.values()))
    text = section(renderings)
    assert text.count("<img") == 6
    assert text.count("failed") == 2


def test_where_nobody_renders_there_is_nothing(rendered_study):
    only = [rendered_study.parts["far-ball"]]
    assert load_held_out_renderings(rendered_study, only).rows == []
    assert section(load_held_out_renderings(rendered_study, only)) == ""


def test_the_album_has_the_first_held_out_view_of_every_part(rendered_study):
    images = load_part_images(rendered_study)
    assert [name for name, _ in images["near-ball"]] == ["image", "hull"]
    tones = [mean_gray(content) for _, content in images["near-ball"]]
    np.testing.assert_allclose(tones, [10, 110], atol=1)
    assert [name for name, _ in images["far-ball"]] == ["image"]
