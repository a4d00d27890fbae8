"""A part stands out from the background chosen for it, or a warning says that it does not."""

import json
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.part import Appearance, Mesh, save_part
from industnerf.artifacts.part_warnings import load_part_warnings
from industnerf.artifacts.views import ARCHIVE, load_views
from industnerf.capture.backgrounds import COLORS, Likeness, contrasting_color
from industnerf.capture.render import background_warning, render_part
from industnerf.geometry.silhouettes import foreground_mask
from tests.archives import members
from tests.samples import unit_part

RING = trimesh.creation.annulus(5, 15, 40, sections=64)
VIEWS = np.arange(6)
GRAYS = np.arange(256, dtype=np.uint8).repeat(3).reshape(-1, 3)


def ring(*albedos: float) -> tuple[Mesh, tuple[Appearance, ...]]:
    """A ring whose height is cut into slices of one gray finish each."""
    height = np.array(RING.triangles_center)[:, 2]
    slices = np.digitize(height, np.linspace(-20, 20, len(albedos) + 1)[1:-1]).astype(np.uint8)
    mesh = Mesh(np.array(RING.vertices, float), np.array(RING.faces, np.int32), slices)
    return mesh, tuple(Appearance(f"gray {kd}", (kd, kd, kd), 0.0, 1.0) for kd in albedos)


@pytest.fixture
def photograph(tmp_path, settings):
    """Renders a ring of the given albedos, on the background named; gives its views."""

    def render(background, *albedos):
        mesh, finishes = ring(*albedos)
        part, target = tmp_path / "ring", tmp_path / "views" / "ring"
        part.mkdir()
        save_part(part, unit_part("ring", finishes=finishes), mesh)
        render_part(part, target, replace(settings, background=background), 0)
        return load_views(target)

    return render


def lost_share(views) -> float:
    """Of the part's pixels, those that a segmentation by color takes for background."""
    mask, colors = views.mask(VIEWS), views.background[VIEWS]
    return float((mask & ~foreground_mask(views.rgb(VIEWS), colors, 0.02)).sum() / mask.sum())


@pytest.mark.parametrize("albedos", [(0.9,), (0.05,), (0.5,), (0.95, 0.02), (0.9, 0.45, 0.02)])
def test_no_finish_is_lost_before_the_shipped_background(photograph, settings, albedos):
    views = photograph(settings.background, *albedos)
    assert lost_share(views) < 2e-3
    assert not load_part_warnings(views.folder.parent, "views")


def test_white_stays_where_it_serves_and_a_light_part_leaves_it(photograph):
    np.testing.assert_array_equal(photograph("contrast", 0.5).background, np.ones((6, 3)))
    assert contrasting_color(np.full((9, 3), 250, np.uint8)) == "black"
    assert contrasting_color(np.array([[0, 0, 0], [255, 255, 255]], np.uint8)) == "gray"
    assert contrasting_color(GRAYS) == "green"


def test_the_color_least_alike_is_taken_where_all_are_in_the_part():
    everything = np.array(list(COLORS.values()), np.uint8)
    colors = np.concatenate([everything.repeat(5, axis=0), everything[:5]])
    assert contrasting_color(colors) == "blue"


def test_the_background_is_declared_for_methods_and_other_tools(photograph):
    views = photograph("contrast", 0.9)
    np.testing.assert_array_equal(views.background, np.zeros((6, 3)))
    np.testing.assert_array_equal(views.rgb(VIEWS)[:, 0, 0], np.zeros((6, 3)))
    transforms = json.loads(members(views.folder / ARCHIVE)["transforms.json"])
    assert transforms["background"] == [0.0, 0.0, 0.0]


def test_a_part_like_its_background_is_warninged_upon(photograph, settings):
    views = photograph("white", 0.9)
    share = lost_share(views)
    assert share > 0.1
    warning = load_part_warnings(views.folder.parent, "views")["ring"][0]
    assert float(warning.split("%")[0]) == pytest.approx(100 * share, rel=0.1)
    assert "views.background" in warning
    early = background_warning(*ring(0.9), replace(settings, background="white"), 0)
    assert float(early.split("%")[0]) == pytest.approx(100 * share, rel=0.2)
    assert not background_warning(*ring(0.9), settings, 0)


def test_one_pixel_in_a_hundred_goes_without_saying():
    white, gray = np.full((1, 3), 255, np.uint8), np.full((99, 3), 100, np.uint8)
    likeness = Likeness()
    likeness.add(np.concatenate([white, gray]), np.ones(3))
    assert likeness.warning == ""
    likeness.add(white, np.ones(3))
    assert likeness.warning.startswith("2.0% of its pixels")


def test_a_part_that_no_camera_sees_is_before_white():
    assert contrasting_color(np.empty((0, 3), np.uint8)) == "white"
