"""The stage's function: from a part's folder to a folder of views."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.part import Mesh
from industnerf.artifacts.views import load_views
from industnerf.capture.photograph import photograph
from industnerf.errors import BadArtifact, BadParams
from industnerf.geometry.cameras import pixel_centres, unproject

RING = trimesh.creation.annulus(5, 15, 40, sections=64)
AT = np.array([300.0, -40, 9])  # mm: parts need not lie at the origin


@pytest.fixture
def block(as_part, as_mesh):
    """Folder of a ring, off the origin."""
    solid = as_mesh(RING)
    return as_part(Mesh(solid.vertices + AT, solid.faces))


def test_all_views_lie_on_the_surface_of_the_part(block, tmp_path, settings):
    photograph(block, tmp_path / "views", settings)
    views = load_views(tmp_path / "views")
    everything = np.arange(len(views.cameras))
    masks, depths = views.mask(everything), views.depth_mm(everything)
    for K, c2w, mask, depth in zip(views.cameras.K, views.cameras.c2w, masks, depths, strict=True):
        assert 0.05 < mask.mean() < 0.7
        np.testing.assert_array_equal(depth > 0, mask)
        shown = mask.ravel()
        points = unproject(pixel_centres(64, 64)[shown], depth.ravel()[shown].astype(float), K, c2w)
        away = trimesh.proximity.closest_point_naive(RING, points[::7] - AT)[1]
        assert away.max() <= 0.5 * views.depth_scale_mm * 1.05  # half a step of the 16 bits


def test_depth_uses_the_16_bits_and_fits_them(block, tmp_path, settings):
    photograph(block, tmp_path / "views", settings)
    views = load_views(tmp_path / "views")
    radius = np.hypot(15, 20)  # of the bounding ball
    assert views.depth_scale_mm * 65535 == pytest.approx((settings.radius + 1) * radius, rel=1e-9)
    assert views.depth_mm(np.arange(6)).max() < (settings.radius + 1) * radius


def test_training_and_held_out_views_are_told_apart(block, tmp_path, settings):
    photograph(block, tmp_path / "views", settings)
    views = load_views(tmp_path / "views")
    assert views.part_id == "block"
    np.testing.assert_array_equal(views.train, [0, 1, 2, 3])
    np.testing.assert_array_equal(views.background, settings.background)


def test_pictures_show_the_background_around_the_part_and_nothing_saturated(
    block, tmp_path, settings
):
    photograph(block, tmp_path / "views", settings)
    views = load_views(tmp_path / "views")
    rgb, mask = views.rgb(np.arange(6)), views.mask(np.arange(6))
    np.testing.assert_array_equal(rgb[:, 0, 0], np.rint(255 * np.tile(settings.background, (6, 1))))
    inner = mask & np.roll(mask, 1, 1) & np.roll(mask, -1, 1) & np.roll(mask, 1, 2)
    inner &= np.roll(mask, -1, 2)
    assert rgb[inner].max() < 255
    assert rgb[inner].min() > 0


def test_the_same_part_gives_the_same_bytes(block, tmp_path, settings):
    for name in ("one", "two"):
        photograph(block, tmp_path / name, settings)
    files = sorted(path.relative_to(tmp_path / "one") for path in tmp_path.glob("one/**/*.*"))
    assert len(files) == 2 + 3 * 6
    for file in files:
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()


def test_a_part_that_is_not_in_frame_leaves_no_files(block, tmp_path, settings):
    with pytest.raises(BadParams, match=r"views\.radius to 3\.864 or views\.fov_deg"):
        photograph(block, tmp_path / "views", replace(settings, radius=3.0, fov_deg=30.0))
    assert not (tmp_path / "views").exists()


def test_a_missing_part_is_named(tmp_path, settings):
    with pytest.raises(BadArtifact, match=r"part\.json is missing"):
        photograph(tmp_path / "nowhere", tmp_path / "views", settings)


def test_a_flat_open_sheet_can_be_photographed(as_part, tmp_path, settings):
    square = np.array([[0.0, 0, 0], [9, 0, 0], [9, 9, 0], [0, 9, 0]])
    sheet = Mesh(square, np.array([[0, 1, 2], [0, 2, 3]], np.int32))
    photograph(as_part(sheet), tmp_path / "views", settings)
    assert load_views(tmp_path / "views").mask(np.arange(6)).any(axis=(1, 2)).all()
