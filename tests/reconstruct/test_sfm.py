"""Cameras from photographs alone, over a stand-in for pycolmap; and by pycolmap, where it is."""

import struct
import sys
from importlib.util import find_spec
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image
from scipy.ndimage import gaussian_filter, map_coordinates
from scipy.spatial import procrustes
from scipy.spatial.transform import Rotation

from industnerf.errors import BadArtifact, ReconstructionFailed
from industnerf.geometry.cameras import (
    Cameras,
    look_at,
    pinhole,
    pixel_centers,
    ray_directions,
)
from industnerf.reconstruct import sfm
from industnerf.reconstruct.camera_files import read_camera_file
from tests.reconstruct import sample_images


class FakeModel:
    """What pycolmap returns: writes cameras of `count` photographs."""

    def __init__(self, names):
        self._names = names

    def num_reg_images(self):
        return len(self._names)

    def compute_mean_reprojection_error(self):
        return 0.25

    def write(self, folder):
        cameras = sample_images.cameras()
        (folder / "cameras.bin").write_bytes(
            struct.pack("<QIiQQ4d", 1, 1, 1, 48, 32, 60.0, 62.0, 25.0, 15.0)
        )
        body = struct.pack("<Q", len(self._names))
        for i, name in enumerate(self._names):
            axes = cameras.c2w[i, :3, :3].T
            quaternion = Rotation.from_matrix(axes).as_quat(scalar_first=True)
            body += struct.pack("<I7dI", i, *quaternion, *(-axes @ cameras.centers[i]), 1)
            body += name.encode() + b"\0" + struct.pack("<Q", 0)
        (folder / "images.bin").write_bytes(body)


@pytest.fixture
def fake_pycolmap(monkeypatch):
    """A stand-in that joins `joined` of the photographs, and counts its runs."""
    state = SimpleNamespace(joined=5, runs=0)

    def map_images(database, image_path, output_path):
        state.runs += 1
        names = sorted(path.name for path in image_path.iterdir())
        return {0: FakeModel(names[:1]), 1: FakeModel(names[: state.joined])}

    module = SimpleNamespace(
        set_random_seed=lambda seed: None,
        logging=SimpleNamespace(),
        CameraMode=SimpleNamespace(SINGLE="single"),
        ImageReaderOptions=lambda camera_model: camera_model,
        extract_features=lambda database, images, **options: None,
        match_exhaustive=lambda database: None,
        incremental_mapping=map_images,
    )
    monkeypatch.setitem(sys.modules, "pycolmap", module)
    return state


@pytest.fixture
def photographs(tmp_path):
    path = sample_images.write_image_set(tmp_path / "set")
    return path.parent / "rgb"


def test_the_largest_model_becomes_the_cameras(photographs, tmp_path, fake_pycolmap):
    fake_pycolmap.joined = 4
    model, sentence = sfm.find_cameras(photographs, tmp_path / "work")
    assert "the cameras of 4 of 5 photographs were found, to 0.25 px" in sentence
    frames = read_camera_file(model).frames
    assert [frame.name for frame in frames] == [f"{i:03d}.png" for i in range(4)]


def test_cameras_that_were_found_are_not_found_again(photographs, tmp_path, fake_pycolmap):
    sfm.find_cameras(photographs, tmp_path / "work")
    _, sentence = sfm.find_cameras(photographs, tmp_path / "work")
    assert fake_pycolmap.runs == 1
    assert "of an earlier run" in sentence
    Image.fromarray(sample_images.images()[0] // 99).save(photographs / "004.png")
    sfm.find_cameras(photographs, tmp_path / "work")
    assert fake_pycolmap.runs == 2  # of other photographs


def test_too_few_cameras_are_a_failure_with_advice(photographs, tmp_path, fake_pycolmap):
    fake_pycolmap.joined = 2
    with pytest.raises(ReconstructionFailed, match=r"2 of 5 photographs .*overlap .*texture"):
        sfm.find_cameras(photographs, tmp_path / "work")


def test_without_pycolmap_the_user_is_told_how(photographs, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pycolmap", None)
    with pytest.raises(BadArtifact, match=r"needs pycolmap.*pip install .*--cameras sparse/0"):
        sfm.find_cameras(photographs, tmp_path / "work")


def test_a_folder_without_photographs_is_refused(tmp_path, fake_pycolmap):
    with pytest.raises(BadArtifact, match="0 photographs, it takes at least 2"):
        sfm.find_cameras(tmp_path, tmp_path / "work")
    with pytest.raises(BadArtifact, match="is no folder"):
        sfm.find_cameras(tmp_path / "none", tmp_path / "work")


def test_the_command_takes_photographs_alone(workspace, fake, fake_pycolmap):
    images = workspace.folder / "set/rgb"
    code, text, errors = workspace.run("--images", images, "--sfm")
    assert (code, errors) == (0, "")
    assert "the cameras of 5 of 5 photographs were found" in text
    np.testing.assert_array_equal(fake.LAST_CALL["posed_images"].rgb, sample_images.images())
    assert (workspace.folder / "cloud.ply.sfm/model/images.bin").exists()
    code, text, _ = workspace.run("--images", images, "--sfm", "--force")
    assert (code, "cameras of an earlier run" in text) == (0, True)
    workspace.run("--images", images, "--sfm", "--force", "--no-resume")
    assert fake_pycolmap.runs == 2


def bumpy_wall(cameras: Cameras) -> list[np.ndarray]:
    """Photographs of a textured plane with a textured step on it, without repetition."""
    rng = np.random.default_rng(0)
    texture = np.stack(
        [sum(k * gaussian_filter(rng.normal(size=(512, 512)), k) for k in (1, 3, 9))] * 3, axis=-1
    )
    texture = (texture - texture.min()) / np.ptp(texture)
    images = []
    for K, c2w in zip(cameras.K, cameras.c2w, strict=True):
        directions = ray_directions(pixel_centers(cameras.width, cameras.height), K, c2w)
        points = c2w[:3, 3] - c2w[2, 3] / directions[:, 2:] * directions
        top = c2w[:3, 3] + (8 - c2w[2, 3]) / directions[:, 2:] * directions
        is_on_step = (np.abs(top[:, :2]) < [20, 15]).all(axis=1)
        xy = np.where(is_on_step[:, None], top[:, :2] + 60, points[:, :2])
        colors = [
            map_coordinates(texture[..., channel], 256 + 2 * xy.T, order=1, mode="nearest")
            for channel in range(3)
        ]
        pixels = np.stack(colors, axis=-1).reshape(cameras.height, cameras.width, 3)
        images.append(np.rint(255 * pixels).astype(np.uint8))
    return images


@pytest.mark.slow
@pytest.mark.skipif(find_spec("pycolmap") is None, reason="pycolmap, the extra `sfm`, is missing")
def test_pycolmap_finds_the_cameras_of_rendered_photographs(tmp_path):
    """Up to a similarity, which is fitted to the centers."""
    angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    eyes = np.stack([60 * np.cos(angle), 60 * np.sin(angle), 90 + 10 * np.cos(3 * angle)], axis=1)
    K = np.tile(pinhole(50.0, 320), (12, 1, 1))
    cameras = Cameras(K, look_at(eyes.copy(), np.zeros(3)), 320, 320)
    (tmp_path / "photos").mkdir()
    for i, pixels in enumerate(bumpy_wall(cameras)):
        Image.fromarray(pixels).save(tmp_path / f"photos/{i:03d}.png")
    model, sentence = sfm.find_cameras(tmp_path / "photos", tmp_path / "work")
    assert "12 of 12" in sentence
    found = np.array([frame.matrix[:3, 3] for frame in read_camera_file(model).frames])
    _, _, disparity = procrustes(eyes, found)
    # of a path some 100 mm long: a pixel is 0.3 mm on the plane
    assert disparity < 1e-4
