"""Masks and alpha cut the part out, so that nothing need be known of what is behind it."""

import json

import numpy as np
import pytest
from PIL import Image

from industnerf.errors import BadArtifact
from industnerf.reconstruct.images import composite, read_image
from industnerf.reconstruct.load_images import load_images
from industnerf.reconstruct.sources import Selection
from tests.reconstruct import sample_images

W, H = sample_images.WIDTH, sample_images.HEIGHT
INSIDE = np.zeros((H, W), bool)
INSIDE[8:24, 12:36] = True
DEEP, FAR = np.zeros_like(INSIDE), np.zeros_like(INSIDE)  # more than a pixel from the outline
DEEP[10:22, 14:34] = True
FAR[:6], FAR[26:], FAR[:, :10], FAR[:, 38:] = True, True, True, True


def write_masked_set(folder, masks, pixels=None):
    """Photographs of clutter, of which `masks` keep the part."""
    path = sample_images.write_image_set(folder)
    (folder / "masks").mkdir()
    content = json.loads(path.read_text())
    for i, mask in enumerate(masks):
        if pixels is not None:
            Image.fromarray(pixels).save(folder / f"rgb/{i:03d}.png")
        if mask is not None:
            Image.fromarray(mask).save(folder / f"masks/{i:03d}.png")
        content["frames"][i]["mask_path"] = f"./masks/{i:03d}.png"
    return sample_images.write_json_file(path, content)


def load(path, background=None, **selection):
    return load_images(
        path, None, max_size=512, background=background, selection=Selection(**selection)
    )


def assert_is_cut_out(image_set):
    color = image_set.background[0]
    np.testing.assert_array_equal(image_set.background, np.tile(color, (5, 1)))
    np.testing.assert_array_equal(image_set.rgb[:, DEEP], sample_images.images()[:, DEEP])
    assert (image_set.rgb[:, FAR] == np.rint(255 * color)).all()


@pytest.mark.parametrize("level", [1, 255])
def test_a_mask_is_what_a_frame_shows_of_the_part(tmp_path, level):
    image_set = load(write_masked_set(tmp_path, [level * INSIDE.astype(np.uint8)] * 5))
    assert_is_cut_out(image_set)
    assert "5 of 5 photographs are cut out by their masks: shown over" in image_set.warnings[0]


def test_a_mask_may_be_smaller_than_its_photograph(tmp_path):
    assert_is_cut_out(load(write_masked_set(tmp_path, [INSIDE[::2, ::2]] * 5)))


def test_a_mask_may_be_the_alpha_of_a_cut_out(tmp_path):
    rgba = np.dstack([np.full((H, W, 3), 77, np.uint8), 255 * INSIDE.astype(np.uint8)])
    assert_is_cut_out(load(write_masked_set(tmp_path, [rgba] * 5)))


def test_a_mask_of_another_shape_is_refused(tmp_path):
    with pytest.raises(BadArtifact, match=r"frame 0 .*the mask .* is 32 x 32 px, its photograph"):
        load(write_masked_set(tmp_path, [INSIDE[:, :32]] * 5))


def test_the_color_behind_is_one_that_the_part_has_not(tmp_path):
    """A white part with black letters before white would lose both to the background."""
    part = np.full((H, W, 3), 255, np.uint8)
    part[12:16, 16:30] = 0
    image_set = load(write_masked_set(tmp_path, [INSIDE] * 5, part))
    color = 255 * image_set.background[0]
    assert min(np.abs(color - 255).max(), np.abs(color).max()) > 200
    assert (load(tmp_path / "transforms.json", (0.0, 0.0, 1.0)).background == [0, 0, 1]).all()


def test_a_gray_part_is_shown_before_white(tmp_path):
    image_set = load(write_masked_set(tmp_path, [INSIDE] * 5, np.full((H, W, 3), 128, np.uint8)))
    assert (image_set.background == 1).all()


def test_masks_may_be_ignored(tmp_path):
    image_set = load(write_masked_set(tmp_path, [INSIDE] * 5), ignore_masks=True)
    np.testing.assert_array_equal(image_set.rgb, sample_images.images())
    assert (image_set.background, image_set.warnings) == (None, ())


def test_missing_masks_are_counted_and_strict_refuses(tmp_path):
    path = write_masked_set(tmp_path, [INSIDE, INSIDE, None, INSIDE, None])
    image_set = load(path)
    assert image_set.background is None
    assert (
        "2 of 5 frames (rgb/002.png, rgb/004.png) have no mask: outlines are looked for by "
        "color" in image_set.warnings
    )
    with pytest.raises(BadArtifact, match=r"have no mask, the first should be masks/002.png"):
        load(path, strict=True)


def test_an_empty_mask_leaves_its_photograph_out(tmp_path):
    """It would say that there is no part at all."""
    image_set = load(write_masked_set(tmp_path, [INSIDE, INSIDE, INSIDE & False, INSIDE, INSIDE]))
    assert [path.name for path in image_set.image_paths] == [f"{i:03d}.png" for i in (0, 1, 3, 4)]
    assert "1 photographs are left out, as their masks leave nothing" in image_set.warnings


def test_inverted_masks_are_told(tmp_path):
    """Such as hide what moves, and keep all else."""
    image_set = load(write_masked_set(tmp_path, [~INSIDE] * 5))
    assert any("5 of 5 masks keep most of the border" in warning for warning in image_set.warnings)


def test_masks_are_no_photographs_without_a_frame(tmp_path):
    path = write_masked_set(tmp_path, [INSIDE] * 5)
    content = json.loads(path.read_text())
    for i, frame in enumerate(content["frames"]):
        (tmp_path / f"masks/{i:03d}.png").rename(tmp_path / f"rgb/{i:03d}_mask.png")
        frame["mask_path"] = f"rgb/{i:03d}_mask.png"
    image_set = load(sample_images.write_json_file(path, content))
    assert not any("no frame names" in warning for warning in image_set.warnings)


def test_a_mask_of_centers_reaches_half_a_pixel_beyond_them(tmp_path):
    """An edge at any angle: the pixels that show any of the part are kept, on the mean."""
    y, x = np.mgrid[:64, :64] + 0.5
    Image.fromarray(np.zeros((64, 64, 3), np.uint8)).save(tmp_path / "a.png")
    excess = []
    for angle in np.radians(np.arange(5, 360, 10)):
        across = (x - 32) * np.cos(angle) + (y - 32) * np.sin(angle)
        Image.fromarray(across < 0).save(tmp_path / "m.png")
        pixels, _ = read_image(tmp_path / "a.png", None, "", tmp_path / "m.png")
        kept = composite(pixels, np.ones(3))[..., 0] < 250
        is_touched = across < (abs(np.cos(angle)) + abs(np.sin(angle))) / 2
        excess.append((kept.sum() - is_touched.sum()) / 64)
    assert abs(np.mean(excess)) < 0.2  # px; without that edge, 0.7


@pytest.mark.parametrize("there", [True, False])
def test_a_photograph_is_no_mask_of_its_own(tmp_path, there):
    """A mask has its photograph's name, in a folder that --images does not lead to."""
    path = write_masked_set(tmp_path, [INSIDE if there else None] * 5)
    (tmp_path / "rgb").rename(tmp_path / "photos")
    image_set = load_images(path, tmp_path / "photos", max_size=512)
    if there:
        assert_is_cut_out(image_set)
    else:
        assert image_set.background is None
        assert any("5 of 5 frames" in text and "no mask" in text for text in image_set.warnings)
