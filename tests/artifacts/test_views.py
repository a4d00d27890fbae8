"""Views: what is written is what is read, by us and by NeRF tools, or an error that names it."""

import io
import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from industnerf.artifacts.views import (
    ARCHIVE,
    RgbdImage,
    Views,
    load_true_cameras,
    load_views,
    save_views,
)
from industnerf.errors import BadArtifact
from industnerf.geometry.cameras import Cameras, look_at, pinhole, project
from industnerf.geometry.sphere import fibonacci_sphere
from tests.archives import members, opened

SIDE, COUNT = 24, 5
STEP = 0.01  # mm of depth


@pytest.fixture
def images() -> list[RgbdImage]:
    rng = np.random.default_rng(0)
    masks = rng.random((COUNT, SIDE, SIDE)) < 0.5
    depths = np.where(masks, rng.uniform(50, 600, masks.shape), 0).astype(np.float32)
    colors = rng.integers(0, 256, (COUNT, SIDE, SIDE, 3), np.uint8)
    return [RgbdImage(*channels) for channels in zip(colors, masks, depths, strict=True)]


@pytest.fixture
def views(tmp_path, images) -> Views:
    camera_centers = 300 * fibonacci_sphere(COUNT)
    cameras = Cameras(
        np.tile(pinhole(35.0, SIDE), (COUNT, 1, 1)),
        look_at(camera_centers, np.zeros(3)),
        SIDE,
        SIDE,
    )
    held_out = np.arange(COUNT) >= 3
    background = np.linspace(0, 1, 3 * COUNT).reshape(COUNT, 3)
    written = Views(tmp_path / "p", "p", cameras, held_out, background, STEP, 0.75)
    save_views(written, images)
    return written


def test_views_survive_their_files(views, images):
    read = load_views(views.folder)
    assert (read.part_id, read.depth_scale_mm, read.train_visible_share) == ("p", STEP, 0.75)
    assert (read.cameras.width, read.cameras.height) == (SIDE, SIDE)
    for name in ("held_out", "background"):
        np.testing.assert_array_equal(getattr(read, name), getattr(views, name))
    np.testing.assert_array_equal(read.cameras.K, views.cameras.K)  # JSON keeps every digit
    np.testing.assert_array_equal(read.cameras.c2w, views.cameras.c2w)
    indices = np.array([4, 1])
    np.testing.assert_array_equal(read.rgb(indices), [images[i].rgb for i in indices])
    np.testing.assert_array_equal(read.mask(indices), [images[i].mask for i in indices])
    # half a step, and the rounding of 600 mm in float32
    depth = [images[i].depth_mm for i in indices]
    np.testing.assert_allclose(read.depth_mm(indices), depth, rtol=0, atol=STEP / 2 + 1e-4)
    np.testing.assert_array_equal(read.depth_mm(indices) > 0, read.mask(indices))


def test_images_are_what_their_names_say(views):
    """Read by pillow alone: 8-bit color, 1-bit mask, 16-bit depth."""
    modes = {}
    for kind in ("rgb", "mask", "depth"):
        png = members(views.folder / ARCHIVE)[f"{kind}/000.png"]
        with Image.open(io.BytesIO(png)) as image:
            modes[kind] = image.mode
            assert image.size == (SIDE, SIDE)
    assert modes == {"rgb": "RGB", "mask": "1", "depth": "I;16"}


def test_nerf_tools_project_as_we_do(views):
    """transforms.json by its own rules: OpenGL axes, the camera looks along -z, +y is up."""
    content = json.loads(members(views.folder / ARCHIVE)["transforms.json"])
    points = np.random.default_rng(1).uniform(-60, 60, (50, 3))
    for frame, K, c2w in zip(content["frames"], views.cameras.K, views.cameras.c2w, strict=True):
        to_camera = np.linalg.inv(np.array(frame["transform_matrix"]))
        x, y, z = (points @ to_camera[:3, :3].T + to_camera[:3, 3]).T
        assert (z < 0).all()
        u = content["cx"] + content["fl_x"] * x / -z
        v = content["cy"] - content["fl_y"] * y / -z
        uv, depth = project(points, K, c2w)
        np.testing.assert_allclose(np.stack([u, v], axis=1), uv, rtol=0, atol=1e-9)
        np.testing.assert_allclose(-z, depth, rtol=1e-12)


def test_the_angle_that_older_nerf_tools_read_gives_the_same_focal_length(views):
    content = json.loads(members(views.folder / ARCHIVE)["transforms.json"])
    focal = 0.5 * content["w"] / np.tan(0.5 * content["camera_angle_x"])
    assert focal == pytest.approx(views.cameras.K[0, 0, 0], rel=1e-12)


def test_cameras_of_different_lenses_have_one_each_for_nerf_tools(views, images, tmp_path):
    """And none for all, which tools would take instead."""
    cameras = views.cameras
    K = cameras.K * np.linspace(1, 1.2, COUNT)[:, None, None]
    K[:, 2, 2] = 1
    cameras = Cameras(K, cameras.c2w, SIDE, SIDE)
    save_views(replace(views, folder=tmp_path / "lenses", cameras=cameras), images)
    content = json.loads(members(tmp_path / "lenses" / ARCHIVE)["transforms.json"])
    assert not {"fl_x", "fl_y", "cx", "cy", "camera_angle_x"} & set(content)
    assert (content["w"], content["h"]) == (SIDE, SIDE)
    for frame, own_K in zip(content["frames"], K, strict=True):
        assert [frame["fl_x"], frame["fl_y"]] == [own_K[0, 0], own_K[1, 1]]
        assert [frame["cx"], frame["cy"]] == [own_K[0, 2], own_K[1, 2]]
        half = np.tan(frame["camera_angle_x"] / 2)
        assert SIDE / 2 / half == pytest.approx(own_K[0, 0], rel=1e-12)


def test_exact_cameras_are_their_own_truth(views):
    assert json.loads(members(views.folder / ARCHIVE)["cameras.json"])["exact"] is True
    assert "true_cameras.json" not in members(views.folder / ARCHIVE)
    np.testing.assert_array_equal(load_true_cameras(views.folder).c2w, views.cameras.c2w)


def test_the_truth_about_wrong_cameras_stands_apart(views, images, tmp_path):
    true_cameras = Cameras(2 * views.cameras.K, views.cameras.c2w + 1.0, SIDE, SIDE)
    save_views(replace(views, folder=tmp_path / "wrong"), images, true_cameras)
    wrong = members(tmp_path / "wrong" / ARCHIVE)
    assert json.loads(wrong["cameras.json"])["exact"] is False
    recorded = load_views(tmp_path / "wrong").cameras
    np.testing.assert_array_equal(recorded.c2w, views.cameras.c2w)
    loaded = load_true_cameras(tmp_path / "wrong")
    np.testing.assert_array_equal(loaded.K, true_cameras.K)
    np.testing.assert_array_equal(loaded.c2w, true_cameras.c2w)
    assert (loaded.width, loaded.height) == (SIDE, SIDE)
    for name in ("rgb/000.png", "mask/001.png", "transforms.json"):
        assert members(views.folder / ARCHIVE)[name] == wrong[name]


def test_files_that_nerf_tools_are_told_of_exist(views):
    content = json.loads(members(views.folder / ARCHIVE)["transforms.json"])
    for frame in content["frames"]:
        for key in ("file_path", "mask_path", "depth_file_path"):
            assert frame[key] in members(views.folder / ARCHIVE)
    assert content["train_filenames"] == [f"rgb/00{i}.png" for i in range(3)]
    assert content["test_filenames"] == [f"rgb/00{i}.png" for i in (3, 4)]


def test_the_photographs_are_one_file_that_other_tools_unpack(views, tmp_path):
    """By any program: here by Python's own, and then read by pillow alone."""
    assert [path.name for path in views.folder.iterdir()] == [ARCHIVE]
    unpack = [
        sys.executable,
        "-m",
        "zipfile",
        "-e",
        str(views.folder / ARCHIVE),
        str(tmp_path / "u"),
    ]
    subprocess.run(unpack, check=True)
    content = json.loads((tmp_path / "u/transforms.json").read_text())
    for frame in content["frames"]:
        with Image.open(tmp_path / "u" / frame["file_path"]) as image:
            assert image.size == (SIDE, SIDE)


def test_equal_photographs_are_equal_bytes_on_another_day(views, images, tmp_path, monkeypatch):
    monkeypatch.setattr("time.time", lambda: 2e9)
    save_views(replace(views, folder=tmp_path / "again"), images)
    assert (tmp_path / "again" / ARCHIVE).read_bytes() == (views.folder / ARCHIVE).read_bytes()


def read_all(folder, kind):
    return getattr(load_views(folder), {"depth": "depth_mm"}.get(kind, kind))(np.array([0, 1]))


@pytest.mark.parametrize("kind", ["rgb", "mask", "depth"])
@pytest.mark.parametrize("num_bytes", [0, 7, 40, 100])
def test_a_torn_image_is_named(views, kind, num_bytes):
    with opened(views.folder / ARCHIVE) as folder:
        path = folder / kind / "001.png"
        path.write_bytes(path.read_bytes()[:num_bytes])
    with pytest.raises(BadArtifact, match=rf"{kind}/001\.png.*doctor.*dvc repro -f -s views"):
        read_all(views.folder, kind)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.9, 0.999])
def test_a_torn_archive_is_named(views, share):
    path = views.folder / ARCHIVE
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
    with pytest.raises(BadArtifact, match=r"photographs\.zip.*doctor.*dvc repro -f -s views"):
        load_views(views.folder)


def test_a_damaged_archive_is_named_or_read(views, images):
    """Wherever a byte is wrong: the picture or our own exception, never that of a library."""
    path = views.folder / ARCHIVE
    original = path.read_bytes()
    refused, places = 0, range(0, len(original), 61)
    for at in places:
        path.write_bytes(original[:at] + bytes([original[at] ^ 1]) + original[at + 1 :])
        try:
            for kind in ("rgb", "mask"):
                expected = [getattr(image, kind) for image in images[:2]]
                np.testing.assert_array_equal(read_all(views.folder, kind), expected)
        except BadArtifact:
            refused += 1
    assert refused > 0.2 * len(places)  # depth and the other views are not read


def test_a_missing_image_is_named(views):
    with opened(views.folder / ARCHIVE) as folder:
        (folder / "mask" / "002.png").unlink()
    with pytest.raises(BadArtifact, match=r"mask/002\.png.*is missing.*dvc repro views"):
        load_views(views.folder).mask(np.array([2]))


def test_an_image_of_another_size_is_refused(views):
    with opened(views.folder / ARCHIVE) as folder:
        Image.new("RGB", (SIDE, SIDE + 1)).save(folder / "rgb" / "000.png")
    with pytest.raises(BadArtifact, match=r"000\.png has \(25, 24\) rows and columns"):
        load_views(views.folder).rgb(np.array([0]))


def test_missing_and_torn_cameras_are_named(views):
    with opened(views.folder / ARCHIVE) as folder:
        path = folder / "cameras.json"
        path.write_text(path.read_text()[:200])
    with pytest.raises(BadArtifact, match="not readable JSON"):
        load_views(views.folder)
    with opened(views.folder / ARCHIVE) as folder:
        (folder / "cameras.json").unlink()
    with pytest.raises(BadArtifact, match=r"cameras\.json is missing"):
        load_views(views.folder)
    (views.folder / ARCHIVE).unlink()
    with pytest.raises(BadArtifact, match=r"photographs\.zip is missing"):
        load_views(views.folder)


def test_cameras_of_another_schema_are_refused(views):
    with opened(views.folder / ARCHIVE) as folder:
        path = folder / "cameras.json"
        path.write_text(json.dumps(json.loads(path.read_text()) | {"schema": 99}))
    with pytest.raises(BadArtifact, match="has schema 99"):
        load_views(views.folder)
