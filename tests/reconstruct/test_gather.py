"""A set of photographs and cameras: what comes out fits together, what does not is named."""

import json
import math

import numpy as np
import pytest
from PIL import Image

from industnerf.artifacts.views import Frame, Views, save_views
from industnerf.errors import BadArtifact
from industnerf.geometry.cameras import project
from industnerf.reconstruct.distortion import Distortion, straightened
from industnerf.reconstruct.gather import gather
from tests.reconstruct import scene

CAMERAS = scene.cameras()


@pytest.fixture
def folder(tmp_path):
    scene.write(tmp_path / "set")
    return tmp_path / "set"


def read(folder, change=None, longest=512, **options):
    path = folder / "transforms.json"
    if change is not None:
        said = json.loads(path.read_text())
        change(said)
        scene.rewrite(path, said)
    return gather(path, None, longest=longest, **options)


def put(folder, i, pixels, **options):
    Image.fromarray(pixels).save(folder / f"rgb/{i:03d}.png", **options)


def test_pixels_and_cameras_come_through(folder):
    album = read(folder)
    np.testing.assert_array_equal(album.rgb, scene.photographs())
    assert (album.cameras.width, album.cameras.height) == (scene.WIDTH, scene.HEIGHT)
    np.testing.assert_array_equal(album.cameras.K, CAMERAS.K)
    # the nearest rotation to a rotation is off by rounding
    np.testing.assert_allclose(album.cameras.c2w, CAMERAS.c2w, rtol=0, atol=1e-14)
    assert album.background is None  # opaque, and nobody said
    assert album.remarks == ()
    assert [path.name for path in album.photos] == [f"{i:03d}.png" for i in range(5)]


def test_what_the_suite_writes_it_reads(tmp_path):
    """Views as a stage writes them, of which the last two are held out."""
    pixels = scene.photographs()
    empty = np.zeros(pixels.shape[1:3])
    frames = [Frame(rgb, empty > 0, empty.astype(np.float32)) for rgb in pixels]
    held_out = np.arange(5) >= 3
    save_views(
        Views(tmp_path, "p", CAMERAS, held_out, np.ones((5, 3)), 0.01, 1.0),
        frames,
    )
    album = read(tmp_path)
    np.testing.assert_array_equal(album.rgb, pixels[:3])
    np.testing.assert_allclose(album.cameras.K, CAMERAS.K[:3], rtol=1e-14)
    assert album.remarks == (
        "3 of 5 frames are used, as `train_filenames` says; --all takes every one",
    )
    assert len(read(tmp_path, every=True).rgb) == 5


def test_reduced_images_keep_their_rays(folder):
    """A point is at the same share of the image's width and height as before."""
    album = read(folder, longest=20)
    assert album.rgb.shape == (5, 13, 20, 3)  # 32 x 20 / 48 = 13.3
    assert (album.cameras.width, album.cameras.height) == (20, 13)
    points = scene.CENTRE + np.random.default_rng(0).uniform(-1, 1, (20, 3))
    for i, c2w in enumerate(CAMERAS.c2w):
        before, _ = project(points, CAMERAS.K[i], c2w)
        after, _ = project(points, album.cameras.K[i], album.cameras.c2w[i])
        size = np.array([scene.WIDTH, scene.HEIGHT])
        # a share of a few roundings, of numbers below 10
        np.testing.assert_allclose(after / [20, 13], before / size, rtol=0, atol=1e-13)
    assert album.remarks == ("5 of 5 photographs were reduced to 20 x 13 px",)


def test_cameras_of_another_size_are_scaled(folder):
    def double(said):
        for key in ("fl_x", "fl_y", "cx", "cy", "w", "h"):
            said[key] *= 2

    album = read(folder, double)
    np.testing.assert_allclose(album.cameras.K, CAMERAS.K, rtol=1e-15)
    (remark,) = album.remarks
    assert "another size than their cameras state" in remark


def test_an_angle_is_of_the_size_that_is_stated(folder):
    """The angle of view is that of the stated width, however large the file is."""

    def angle(said):
        for key in ("fl_x", "fl_y", "cx", "cy"):
            del said[key]
        said |= {"w": 480, "h": 320, "camera_angle_x": 2 * math.atan(0.5)}

    K = read(folder, angle).cameras.K[0]
    np.testing.assert_allclose(K, [[48, 0, 24], [0, 48, 16], [0, 0, 1]], rtol=1e-14)


def test_a_bare_file_is_of_the_size_of_its_images(folder):
    def bare(said):
        for key in ("fl_x", "fl_y", "cx", "cy", "w", "h"):
            del said[key]
        said["camera_angle_x"] = 2 * math.atan(0.5)

    K = read(folder, bare).cameras.K[0]
    np.testing.assert_allclose(K, [[48, 0, 24], [0, 48, 16], [0, 0, 1]], rtol=1e-14)


def test_each_frame_may_have_a_lens_of_its_own(folder):
    album = read(folder, lambda said: said["frames"][2].update(fl_x=33.0, cx=20.0))
    assert album.cameras.K[2].tolist() == [[33, 0, 20], [0, 33, 15], [0, 0, 1]]
    np.testing.assert_array_equal(album.cameras.K[1], CAMERAS.K[1])


def test_another_shape_is_refused_with_both_sizes(folder):
    with pytest.raises(BadArtifact) as refusal:
        read(folder, lambda said: said.update(w=32, h=48))
    for word in ("frame 0 (rgb/000.png)", "000.png is 48 x 32 px", "says 32 x 48 px"):
        assert word in str(refusal.value)


def test_two_sizes_in_one_set_are_refused_with_both_files(folder):
    put(folder, 3, scene.photographs()[3].repeat(2, axis=0).repeat(2, axis=1))
    with pytest.raises(BadArtifact) as refusal:
        read(folder)
    for word in ("000.png is 48 x 32 px", "003.png is 96 x 64 px", "must have one size"):
        assert word in str(refusal.value)


def see_through(folder, which, level=0):
    for i in which:
        alpha = np.full((scene.HEIGHT, scene.WIDTH, 1), level, np.uint8)
        put(folder, i, np.concatenate([scene.photographs()[i], alpha], axis=2))


def test_a_see_through_set_has_a_known_background(folder):
    see_through(folder, range(5))
    album = read(folder)
    assert (album.rgb == 255).all()
    np.testing.assert_array_equal(album.background, np.ones((5, 3)))
    assert album.remarks == ("5 of 5 photographs are see-through: shown over #ffffff",)
    assert (read(folder, background=(0.0, 0.0, 0.0)).rgb == 0).all()


def test_a_background_is_known_if_it_is_given_or_all_have_it(folder):
    see_through(folder, [1])
    album = read(folder)
    assert album.background is None
    assert album.remarks == ("1 of 5 photographs are see-through: shown over #ffffff",)
    given = read(folder, background=(0.0, 0.0, 1.0))
    np.testing.assert_array_equal(given.background, [[0, 0, 1]] * 5)


def test_opaque_photographs_show_their_own_background(folder):
    """Many tools save an alpha channel of 255 everywhere."""
    see_through(folder, range(5), level=255)
    album = read(folder)
    np.testing.assert_array_equal(album.rgb, scene.photographs())
    assert album.background is None
    assert album.remarks == ()


def test_a_scaled_rotation_is_remarked(folder):
    def scaled(said):
        matrix = np.array(said["frames"][1]["transform_matrix"])
        matrix[:3, :3] *= 0.1
        said["frames"][1]["transform_matrix"] = matrix.tolist()

    album = read(folder, scaled)
    np.testing.assert_allclose(album.cameras.c2w, CAMERAS.c2w, rtol=0, atol=1e-14)
    (remark,) = album.remarks
    assert remark.startswith("1 of 5 photographs have a rotation that carries a scale")


def test_images_that_no_frame_names_are_remarked_and_the_first_named(folder):
    def fewer(said):
        del said["frames"][0], said["frames"][-1]

    album = read(folder, fewer)
    assert len(album.rgb) == 3
    said = "images that no frame names, left out: "
    assert album.remarks == (f"{said}2 (000.png, 004.png)",)
    for i in (6, 7):
        put(folder, i, scene.photographs()[0])
    assert read(folder).remarks == (f"{said}4 (000.png, 004.png, 006.png, ...)",)


def test_one_view_is_too_few(folder):
    with pytest.raises(BadArtifact, match="1 view to work on, it takes at least 2"):
        read(folder, lambda said: said.update(frames=said["frames"][:1]))


def test_cameras_are_checked_before_any_photograph_is_read(folder):
    (folder / "rgb/000.png").write_text("no image")
    with pytest.raises(BadArtifact, match=r"frame 4 \(rgb/004.png\): camera model"):
        read(folder, lambda said: said["frames"][4].update(camera_model="OPENCV_FISHEYE"))


def test_photographs_of_a_lens_that_bends_lines_are_straightened(folder):
    album = read(folder, lambda said: said.update(k1=-0.2, p2=1e-3))
    taken, lens = scene.cameras(), Distortion(k1=-0.2, p2=1e-3)
    for photo, rgb, K, was in zip(
        scene.photographs(), album.rgb, album.cameras.K, taken.K, strict=True
    ):
        straight, pinhole = straightened(photo, was, lens, "")
        np.testing.assert_array_equal(rgb, straight)
        np.testing.assert_allclose(K, pinhole)
    assert album.remarks == ("5 of 5 photographs were straightened, as their lens bends lines",)


def test_each_photograph_ticks(folder):
    ticks = []
    read(folder, tick=lambda *now: ticks.append(now))
    assert ticks == [(i, 5) for i in range(1, 6)]
