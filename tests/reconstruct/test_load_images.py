"""A set of photographs and cameras: what comes out fits together, what does not is named."""

import json
import math
import zipfile

import numpy as np
import pytest
from PIL import Image
from scipy.ndimage import binary_dilation, binary_erosion

from industnerf.artifacts.views import ARCHIVE, RgbdImage, Views, save_views
from industnerf.errors import BadArtifact
from industnerf.geometry.cameras import project
from industnerf.reconstruct.camera_models import Distortion, undistort
from industnerf.reconstruct.load_images import load_images, to_hex
from industnerf.reconstruct.sources import Selection
from tests.reconstruct import sample_images

CAMERAS = sample_images.cameras()


@pytest.fixture
def folder(tmp_path):
    sample_images.write_image_set(tmp_path / "set")
    return tmp_path / "set"


def load(folder, change=None, max_size=512, **options):
    path = folder / "transforms.json"
    if change is not None:
        transforms = json.loads(path.read_text())
        change(transforms)
        sample_images.write_json_file(path, transforms)
    return load_images(path, None, max_size=max_size, **options)


def save_image(folder, i, pixels, **options):
    Image.fromarray(pixels).save(folder / f"rgb/{i:03d}.png", **options)


def test_pixels_and_cameras_come_through(folder):
    image_set = load(folder)
    np.testing.assert_array_equal(image_set.rgb, sample_images.images())
    assert (image_set.cameras.width, image_set.cameras.height) == (
        sample_images.WIDTH,
        sample_images.HEIGHT,
    )
    np.testing.assert_array_equal(image_set.cameras.K, CAMERAS.K)
    # the nearest rotation to a rotation is off by rounding
    np.testing.assert_allclose(image_set.cameras.c2w, CAMERAS.c2w, rtol=0, atol=1e-14)
    assert image_set.background is None  # opaque, and nobody said
    assert image_set.warnings == ()
    assert [path.name for path in image_set.image_paths] == [f"{i:03d}.png" for i in range(5)]


def test_what_the_suite_writes_it_reads(tmp_path):
    """Views as a stage writes them, of which the last two are held out; masks are in them."""
    pixels = sample_images.images()
    mask = np.zeros(pixels.shape[1:3], bool)
    mask[4:-4, 4:-4] = True
    frames = [RgbdImage(rgb, mask, mask.astype(np.float32)) for rgb in pixels]
    held_out = np.arange(5) >= 3
    save_views(
        Views(tmp_path, "p", CAMERAS, held_out, np.ones((5, 3)), 0.01, 1.0),
        frames,
    )
    with zipfile.ZipFile(tmp_path / ARCHIVE) as archive:
        archive.extractall(tmp_path)
    image_set = load(tmp_path)
    within, beyond = binary_erosion(mask), ~binary_dilation(mask)  # by a pixel, of mixed color
    np.testing.assert_array_equal(image_set.rgb[:, within], pixels[:3, within])
    color = image_set.rgb[0, 0, 0]
    assert (image_set.rgb[:, beyond] == color).all()
    np.testing.assert_array_equal(image_set.background, np.tile(color / 255, (3, 1)))
    np.testing.assert_allclose(image_set.cameras.K, CAMERAS.K[:3], rtol=1e-14)
    assert image_set.warnings == (
        "3 of 5 frames are used, as `train_filenames` says; --all-frames takes every one",
        f"3 of 3 photographs are cut out by their masks: shown over {to_hex(color / 255)}",
    )
    whole = load(tmp_path, selection=Selection(ignore_masks=True))
    np.testing.assert_array_equal(whole.rgb, pixels[:3])
    assert len(load(tmp_path, selection=Selection(all_frames=True)).rgb) == 5


def test_reduced_images_keep_their_rays(folder):
    """A point is at the same share of the image's width and height as before."""
    image_set = load(folder, max_size=20)
    assert image_set.rgb.shape == (5, 13, 20, 3)  # 32 x 20 / 48 = 13.3
    assert (image_set.cameras.width, image_set.cameras.height) == (20, 13)
    points = sample_images.CENTER + np.random.default_rng(0).uniform(-1, 1, (20, 3))
    for i, c2w in enumerate(CAMERAS.c2w):
        before, _ = project(points, CAMERAS.K[i], c2w)
        after, _ = project(points, image_set.cameras.K[i], image_set.cameras.c2w[i])
        size = np.array([sample_images.WIDTH, sample_images.HEIGHT])
        # a share of a few roundings, of numbers below 10
        np.testing.assert_allclose(after / [20, 13], before / size, rtol=0, atol=1e-13)
    assert image_set.warnings == ("5 of 5 photographs were reduced to 20 x 13 px",)


def test_cameras_of_another_size_are_scaled(folder):
    def double(transforms):
        for key in ("fl_x", "fl_y", "cx", "cy", "w", "h"):
            transforms[key] *= 2

    image_set = load(folder, double)
    np.testing.assert_allclose(image_set.cameras.K, CAMERAS.K, rtol=1e-15)
    (warning,) = image_set.warnings
    assert "another size than their cameras state" in warning


def test_an_angle_is_of_the_size_that_is_stated(folder):
    """The angle of view is that of the stated width, however large the file is."""

    def angle(transforms):
        for key in ("fl_x", "fl_y", "cx", "cy"):
            del transforms[key]
        transforms |= {"w": 480, "h": 320, "camera_angle_x": 2 * math.atan(0.5)}

    K = load(folder, angle).cameras.K[0]
    np.testing.assert_allclose(K, [[48, 0, 24], [0, 48, 16], [0, 0, 1]], rtol=1e-14)


def test_a_bare_file_is_of_the_size_of_its_images(folder):
    def bare(transforms):
        for key in ("fl_x", "fl_y", "cx", "cy", "w", "h"):
            del transforms[key]
        transforms["camera_angle_x"] = 2 * math.atan(0.5)

    K = load(folder, bare).cameras.K[0]
    np.testing.assert_allclose(K, [[48, 0, 24], [0, 48, 16], [0, 0, 1]], rtol=1e-14)


def test_each_frame_may_have_a_lens_of_its_own(folder):
    image_set = load(folder, lambda said: said["frames"][2].update(fl_x=33.0, cx=20.0))
    assert image_set.cameras.K[2].tolist() == [[33, 0, 20], [0, 33, 15], [0, 0, 1]]
    np.testing.assert_array_equal(image_set.cameras.K[1], CAMERAS.K[1])


def test_another_shape_is_refused_with_both_sizes(folder):
    with pytest.raises(BadArtifact) as refusal:
        load(folder, lambda said: said.update(w=32, h=48))
    for word in ("frame 0 (rgb/000.png)", "000.png is 48 x 32 px", "says 32 x 48 px"):
        assert word in str(refusal.value)


def save_transparent(folder, indices, alpha_value=0):
    for i in indices:
        alpha = np.full((sample_images.HEIGHT, sample_images.WIDTH, 1), alpha_value, np.uint8)
        alpha[-1, -1] = 255  # one pixel of a part, else there is nothing in the photograph
        save_image(folder, i, np.concatenate([sample_images.images()[i], alpha], axis=2))


def test_a_see_through_set_has_a_known_background(folder):
    save_transparent(folder, range(5))
    image_set = load(folder)
    assert (image_set.rgb[:, :-1] == 255).all()
    np.testing.assert_array_equal(image_set.background, np.ones((5, 3)))
    assert image_set.warnings == ("5 of 5 photographs are see-through: shown over #ffffff",)
    assert (load(folder, background=(0.0, 0.0, 0.0)).rgb[:, :-1] == 0).all()


def test_a_background_is_known_if_it_is_given_or_all_have_it(folder):
    save_transparent(folder, [1])
    image_set = load(folder)
    assert image_set.background is None
    assert image_set.warnings == ("1 of 5 photographs are see-through: shown over #ffffff",)
    with_background = load(folder, background=(0.0, 0.0, 1.0))
    np.testing.assert_array_equal(with_background.background, [[0, 0, 1]] * 5)


def test_opaque_photographs_show_their_own_background(folder):
    """Many tools save an alpha channel of 255 everywhere."""
    save_transparent(folder, range(5), alpha_value=255)
    image_set = load(folder)
    np.testing.assert_array_equal(image_set.rgb, sample_images.images())
    assert image_set.background is None
    assert image_set.warnings == ()


def test_a_scaled_rotation_is_remarked(folder):
    def scaled(transforms):
        matrix = np.array(transforms["frames"][1]["transform_matrix"])
        matrix[:3, :3] *= 0.1
        transforms["frames"][1]["transform_matrix"] = matrix.tolist()

    image_set = load(folder, scaled)
    np.testing.assert_allclose(image_set.cameras.c2w, CAMERAS.c2w, rtol=0, atol=1e-14)
    (warning,) = image_set.warnings
    assert warning.startswith("1 of 5 photographs have a rotation that carries a scale")


def test_images_that_no_frame_names_are_remarked_and_the_first_named(folder):
    def fewer(transforms):
        del transforms["frames"][0], transforms["frames"][-1]

    image_set = load(folder, fewer)
    assert len(image_set.rgb) == 3
    prefix = "images that no frame names, left out: "
    assert image_set.warnings == (f"{prefix}2 (000.png, 004.png)",)
    for i in (6, 7):
        save_image(folder, i, sample_images.images()[0])
    assert load(folder).warnings == (f"{prefix}4 (000.png, 004.png, 006.png, ...)",)


def test_one_view_is_too_few(folder):
    with pytest.raises(BadArtifact, match="1 view to work on, it takes at least 2"):
        load(folder, lambda said: said.update(frames=said["frames"][:1]))


def test_cameras_are_checked_before_any_photograph_is_read(folder):
    (folder / "rgb/000.png").write_text("no image")
    with pytest.raises(BadArtifact, match=r"frame 4 \(rgb/004.png\): camera model"):
        load(folder, lambda said: said["frames"][4].update(camera_model="OPENCV_FISHEYE"))


def test_photographs_of_a_lens_that_bends_lines_are_straightened(folder):
    image_set = load(folder, lambda said: said.update(k1=-0.2, p2=1e-3))
    captured, distortion = sample_images.cameras(), Distortion(k1=-0.2, p2=1e-3)
    for image, rgb, K, original_K in zip(
        sample_images.images(), image_set.rgb, image_set.cameras.K, captured.K, strict=True
    ):
        undistorted, pinhole_K = undistort(image, original_K, distortion, "")
        np.testing.assert_array_equal(rgb, undistorted)
        np.testing.assert_allclose(K, pinhole_K)
    assert image_set.warnings == (
        "5 of 5 photographs were straightened, as their lens bends lines",
    )


def test_each_photograph_ticks(folder):
    ticks = []
    load(folder, on_image_loaded=lambda *now: ticks.append(now))
    assert ticks == [(i, 5) for i in range(1, 6)]
