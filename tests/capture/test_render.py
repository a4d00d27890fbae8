"""The stage's function: from a part's folder to a folder of views."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.part import UNSPECIFIED, Appearance, Mesh, save_part
from industnerf.artifacts.views import ARCHIVE, load_true_cameras, load_views
from industnerf.capture.backgrounds import backgrounds
from industnerf.capture.render import render_part
from industnerf.capture.rng import random_streams
from industnerf.errors import BadArtifact, BadParams
from industnerf.geometry.cameras import pixel_centers, unproject
from industnerf.schema import CalibrationParams, JitterParams, SensorParams, ViewsParams
from tests.archives import members
from tests.samples import unit_part

RING = trimesh.creation.annulus(5, 15, 40, sections=64)
RING_POSITION = np.array([300.0, -40, 9])  # mm: parts need not lie at the origin


@pytest.fixture
def block(as_part, as_mesh):
    """Folder of a ring, off the origin."""
    solid = as_mesh(RING)
    return as_part(Mesh.with_one_appearance(solid.vertices + RING_POSITION, solid.faces))


def test_all_views_lie_on_the_surface_of_the_part(block, tmp_path, settings):
    render_part(block, tmp_path / "views", settings, 0)
    views = load_views(tmp_path / "views")
    everything = np.arange(len(views.cameras))
    masks, depths = views.mask(everything), views.depth_mm(everything)
    for K, c2w, mask, depth in zip(views.cameras.K, views.cameras.c2w, masks, depths, strict=True):
        assert 0.05 < mask.mean() < 0.7
        np.testing.assert_array_equal(depth > 0, mask)
        is_foreground = mask.ravel()
        points = unproject(
            pixel_centers(64, 64)[is_foreground], depth.ravel()[is_foreground].astype(float), K, c2w
        )
        distances = trimesh.proximity.closest_point_naive(RING, points[::7] - RING_POSITION)[1]
        assert distances.max() <= 0.5 * views.depth_scale_mm * 1.05  # half a step of the 16 bits


def test_depth_uses_the_16_bits_and_fits_them(block, tmp_path, settings):
    render_part(block, tmp_path / "views", settings, 0)
    views = load_views(tmp_path / "views")
    radius = np.hypot(15, 20)  # of the bounding ball
    assert views.depth_scale_mm * 65535 == pytest.approx((settings.radius + 1) * radius, rel=1e-9)
    assert views.depth_mm(np.arange(6)).max() < (settings.radius + 1) * radius


def test_training_and_held_out_views_are_told_apart(block, tmp_path, settings):
    render_part(block, tmp_path / "views", settings, 0)
    views = load_views(tmp_path / "views")
    assert views.part_id == "block"
    np.testing.assert_array_equal(views.train_indices, [0, 1, 2, 3])
    np.testing.assert_array_equal(views.background, np.ones((6, 3)))


def test_pictures_show_the_background_around_the_part_and_nothing_saturated(
    block, tmp_path, settings
):
    render_part(block, tmp_path / "views", settings, 0)
    views = load_views(tmp_path / "views")
    rgb, mask = views.rgb(np.arange(6)), views.mask(np.arange(6))
    np.testing.assert_array_equal(rgb[:, 0, 0], np.full((6, 3), 255))
    inner = mask & np.roll(mask, 1, 1) & np.roll(mask, -1, 1) & np.roll(mask, 1, 2)
    inner &= np.roll(mask, -1, 2)
    assert rgb[inner].max() < 255
    assert rgb[inner].min() > 0


def test_the_same_part_gives_the_same_bytes(block, tmp_path, settings):
    for name in ("one", "two"):
        render_part(block, tmp_path / name, settings, 0)
    assert [path.name for path in (tmp_path / "one").iterdir()] == [ARCHIVE]
    assert len(members(tmp_path / "one" / ARCHIVE)) == 2 + 3 * 6
    one, two = (tmp_path / name / ARCHIVE for name in ("one", "two"))
    assert one.read_bytes() == two.read_bytes()


# --- knobs -----------------------------------------------------------------------------------


def with_all_randomness(settings: ViewsParams) -> ViewsParams:
    """All that is random, and all that a sensor does."""
    return replace(
        settings,
        rig="turntable",
        shading="photorealistic",
        background="random",
        light=replace(settings.light, rotation_jitter_deg=20.0, intensity_jitter=0.2),
        jitter=JitterParams(distance=0.1, look_at=0.05, roll_deg=10.0, focal=0.1),
        calibration=CalibrationParams(rotation_deg=1.0, position=0.01, focal=0.01),
        sensor=SensorParams(blur_px=1.0, noise=0.02, jpeg_quality=80),
    )


def files_below(folder: Path) -> dict[str, bytes]:
    return members(folder / ARCHIVE)


def test_with_every_knob_the_same_seed_gives_the_same_bytes_and_another_others(
    block, tmp_path, settings
):
    for name, seed in (("one", 1), ("same", 1), ("other", 2)):
        render_part(block, tmp_path / name, with_all_randomness(settings), seed)
    one, same, other = (files_below(tmp_path / name) for name in ("one", "same", "other"))
    assert one == same
    assert one.keys() == other.keys()
    assert all(one[name] != other[name] for name in one)


def test_without_a_random_knob_the_seed_does_not_matter(block, tmp_path, settings):
    for name, seed in (("one", 1), ("two", 2)):
        render_part(block, tmp_path / name, settings, seed)
    assert files_below(tmp_path / "one") == files_below(tmp_path / "two")


@pytest.mark.parametrize(
    ("change", "touched"),
    [
        ({"calibration": CalibrationParams(1.0, 0.01, 0.01)}, {"cameras.json", "transforms.json"}),
        ({"sensor": SensorParams(1.0, 0.02, 80)}, {"rgb"}),
        ({"shading": "photorealistic"}, {"rgb"}),
        ({"background": "gray"}, {"cameras.json", "transforms.json", "rgb"}),
    ],
    ids=["calibration", "sensor", "photorealistic", "background"],
)
def test_a_knob_touches_what_it_is_for(block, tmp_path, settings, change, touched):
    render_part(block, tmp_path / "before", settings, 0)
    render_part(block, tmp_path / "after", replace(settings, **change), 0)
    before, after = (files_below(tmp_path / name) for name in ("before", "after"))
    new = set(after) - set(before)
    assert new == ({"true_cameras.json"} if "calibration" in change else set())
    assert {name.split("/")[0] for name in before if before[name] != after[name]} == touched


def test_wrong_cameras_keep_their_truth_and_held_out_ones_are_exact(block, tmp_path, settings):
    render_part(block, tmp_path / "before", settings, 0)
    wrong = replace(settings, calibration=CalibrationParams(1.0, 0.01, 0.01))
    render_part(block, tmp_path / "after", wrong, 0)
    before, after = (load_views(tmp_path / name) for name in ("before", "after"))
    np.testing.assert_array_equal(load_true_cameras(after.folder).c2w, before.cameras.c2w)
    np.testing.assert_array_equal(load_true_cameras(after.folder).K, before.cameras.K)
    same = (before.cameras.c2w == after.cameras.c2w).all(axis=(1, 2))
    np.testing.assert_array_equal(same, before.held_out)
    assert after.train_visible_share == before.train_visible_share


def test_jittered_views_lie_on_the_surface_of_the_part(block, tmp_path, settings):
    """The recorded cameras are those that took the pictures."""
    jitter = JitterParams(distance=0.3, look_at=0.05, roll_deg=30.0, focal=0.2)
    render_part(block, tmp_path / "views", replace(settings, jitter=jitter), 0)
    views = load_views(tmp_path / "views")
    assert len(np.unique(views.cameras.K[:, 0, 0])) == 6
    depths = views.depth_mm(np.arange(6))
    for K, c2w, depth in zip(views.cameras.K, views.cameras.c2w, depths, strict=True):
        is_foreground = depth.ravel() > 0
        points = unproject(
            pixel_centers(64, 64)[is_foreground], depth.ravel()[is_foreground].astype(float), K, c2w
        )
        distances = trimesh.proximity.closest_point_naive(RING, points[::7] - RING_POSITION)[1]
        assert distances.max() <= 0.5 * views.depth_scale_mm * 1.05
        border = np.concatenate([depth[0], depth[-1], depth[:, 0], depth[:, -1]])
        assert not border.any()


def test_a_random_background_is_recorded_as_the_picture_shows_it(block, tmp_path, settings):
    render_part(block, tmp_path / "views", replace(settings, background="random"), 0)
    views = load_views(tmp_path / "views")
    corner = views.rgb(np.arange(6))[:, 0, 0]
    np.testing.assert_array_equal(corner, np.rint(255 * views.background))
    assert len(np.unique(corner, axis=0)) == 6


def test_a_part_shows_the_colors_of_its_finishes(tmp_path, settings):
    """The ring, its upper half red paint and its lower half as views.albedo has it."""
    upper = (np.array(RING.triangles_center)[:, 2] > 0).astype(np.uint8)
    mesh = Mesh(np.array(RING.vertices, float), np.array(RING.faces, np.int32), upper)
    red = Appearance("red paint", (0.5, 0.1, 0.1), 0.0, 0.4)
    part = tmp_path / "ring"
    part.mkdir()
    save_part(part, unit_part("ring", finishes=(UNSPECIFIED, red)), mesh)
    render_part(part, tmp_path / "views", settings, 0)
    views = load_views(tmp_path / "views")
    rgb = views.rgb(np.arange(6))[views.mask(np.arange(6))].astype(float)
    reddish = rgb[:, 0] > 2 * rgb[:, 1]
    assert 0.2 < reddish.mean() < 0.8
    # channels of one finish keep the ratio of its albedo, to the rounding of dark pixels
    assert np.median(rgb[reddish, 1] / rgb[reddish, 0]) == pytest.approx(0.2, abs=0.01)
    ratio = settings.albedo[0] / settings.albedo[2]
    assert np.median(rgb[~reddish, 0] / rgb[~reddish, 2]) == pytest.approx(ratio, abs=0.01)


def test_the_share_that_training_views_see_leaves_out_what_is_enclosed(
    as_part, as_mesh, tmp_path, settings
):
    """A cube in a larger closed cube is never seen: its share of the area is 1 / 10."""
    inner = trimesh.creation.box((10, 10, 10))
    outer = trimesh.creation.box((30, 30, 30))
    mesh = as_mesh(trimesh.util.concatenate([inner, outer]))
    render_part(as_part(mesh), tmp_path / "views", replace(settings, count=12), 0)
    # 4096 samples know a share of 0.1 to 0.5 %, five times that is chance once in 1e6
    share = load_views(tmp_path / "views").train_visible_share
    assert share == pytest.approx(0.9, abs=0.025)


def test_held_out_views_do_not_count_as_seeing(block, tmp_path, settings):
    for held_out in (0, 5):
        few = replace(settings, count=1, held_out=held_out)
        render_part(block, tmp_path / str(held_out), few, 0)
    alone, among = (load_views(tmp_path / name).train_visible_share for name in ("0", "5"))
    assert alone == among < 0.6


def test_fewer_training_views_see_less(block, tmp_path, settings):
    """From above alone, nothing of the underside."""
    above = replace(settings, rig="turntable", elevations_deg=[80.0])
    render_part(block, tmp_path / "all", replace(settings, count=20), 0)
    render_part(block, tmp_path / "above", above, 0)
    everything, upper = (
        load_views(tmp_path / name).train_visible_share for name in ("all", "above")
    )
    below = np.pi * (15**2 - 5**2)
    area = 2 * below + 2 * np.pi * (15 + 5) * 40
    assert upper < everything - 0.8 * below / area


def test_a_part_that_is_not_in_frame_leaves_no_files(block, tmp_path, settings):
    with pytest.raises(BadParams, match=r"views\.radius to 3\.864 or views\.fov_deg"):
        render_part(block, tmp_path / "views", replace(settings, radius=3.0, fov_deg=30.0), 0)
    assert not (tmp_path / "views").exists()


def test_a_missing_part_is_named(tmp_path, settings):
    with pytest.raises(BadArtifact, match=r"part\.json is missing"):
        render_part(tmp_path / "nowhere", tmp_path / "views", settings, 0)


def test_a_flat_open_sheet_can_be_photographed(as_part, tmp_path, settings):
    square = np.array([[0.0, 0, 0], [9, 0, 0], [9, 9, 0], [0, 9, 0]])
    sheet = Mesh.with_one_appearance(square, np.array([[0, 1, 2], [0, 2, 3]], np.int32))
    render_part(as_part(sheet), tmp_path / "views", settings, 0)
    assert load_views(tmp_path / "views").mask(np.arange(6)).any(axis=(1, 2)).all()


@pytest.mark.parametrize(("name", "level"), [("white", 255), ("gray", 128), ("black", 0)])
def test_a_named_background_is_the_same_in_all_views(settings, name, level):
    levels = backgrounds(
        replace(settings, background=name), random_streams(0, "part", settings), []
    )
    np.testing.assert_array_equal(levels, np.full((6, 3), level / 255))


def test_random_backgrounds_differ_and_are_whole_levels(shipped):
    settings = replace(shipped, background="random", count=392)
    levels = 255 * backgrounds(settings, random_streams(0, "part", settings), [])
    np.testing.assert_allclose(levels, np.rint(levels), rtol=0, atol=1e-9)
    assert len(np.unique(levels, axis=0)) == 400
    # 1200 levels, uniform: their mean is 127.5 to 73.9 / sqrt(1200) = 2.1; five times that is
    # chance once in 1e6
    assert levels.mean() == pytest.approx(127.5, abs=10.7)
    other = 255 * backgrounds(settings, random_streams(1, "part", settings), [])
    assert not np.array_equal(levels, other)
