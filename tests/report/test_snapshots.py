"""Held-out photographs stand beside the renderings of the same cameras."""

import io

import numpy as np
import pytest
from PIL import Image

from industnerf.artifacts.renderings import Renderings
from industnerf.artifacts.views import Frame, Views, save_views
from industnerf.geometry.cameras import Cameras, look_at, pinhole
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.report.figures import renderings
from industnerf.report.snapshots import SIDE, album, snapshots
from tests.report import gallery

PX = 2 * SIDE


def grey(content: bytes) -> float:
    return float(np.asarray(Image.open(io.BytesIO(content))).mean())


@pytest.fixture
def photographed(tmp_path):
    """Views 1, 2 and 3 of four are held out: 10, 20 and 30; renderings are 100 lighter."""
    eyes = 300 * fibonacci_sphere(4)
    K = np.tile(pinhole(35.0, PX), (4, 1, 1))
    cameras = Cameras(K, look_at(eyes, np.zeros(3)), PX, PX)
    flat, tones = np.zeros((PX, PX)), [np.full((PX, PX, 3), 10 * i, np.uint8) for i in range(4)]
    for name in gallery.PARTS:
        gallery.lay_out(tmp_path, name)
        folder = tmp_path / "nowhere" / name
        held_out = np.array([False, True, True, True])
        views = Views(folder, name, cameras, held_out, np.ones((4, 3)), 0.1, 1.0)
        save_views(views, [Frame(tone, flat > 0, flat.astype(np.float32)) for tone in tones])
    depth = np.zeros((3, PX, PX), np.float32)
    made = Renderings(np.stack(tones[1:]) + np.uint8(100), depth, depth.astype(np.uint8))
    made.save(tmp_path / "hull" / "near-ball")
    return gallery.study(tmp_path)


def test_each_photograph_has_the_answer_of_its_own_camera(photographed):
    taken = snapshots(photographed, list(photographed.parts.values()))
    assert taken.methods == ["hull"]
    (near, pictures), (far, without) = taken.rows
    assert (near.part_id, far.part_id) == gallery.PARTS
    tones = [[grey(content) for content in view] for view in pictures]
    np.testing.assert_allclose(tones, [[10, 110], [30, 130]], atol=1)  # the first and the last
    assert [view[1] for view in without] == [None, None]
    assert Image.open(io.BytesIO(pictures[0][0])).size == (SIDE, SIDE)


def test_on_the_page_what_failed_says_so(photographed):
    text = renderings(snapshots(photographed, list(photographed.parts.values())))
    assert text.count("<img") == 6
    assert text.count("failed") == 2


def test_where_nobody_renders_there_is_nothing(photographed):
    only = [photographed.parts["far-ball"]]
    assert snapshots(photographed, only).rows == []
    assert renderings(snapshots(photographed, only)) == ""


def test_the_album_has_the_first_held_out_view_of_every_part(photographed):
    found = album(photographed)
    assert [name for name, _ in found["near-ball"]] == ["photograph", "hull"]
    tones = [grey(content) for _, content in found["near-ball"]]
    np.testing.assert_allclose(tones, [10, 110], atol=1)
    assert [name for name, _ in found["far-ball"]] == ["photograph"]
