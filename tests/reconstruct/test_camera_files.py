"""Cameras of any program: the same photographs and poses, whatever the file; others are named."""

import json
import shlex
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation

from industnerf.artifacts.views import OPENGL
from industnerf.errors import BadArtifact
from industnerf.reconstruct.camera_files import read_camera_file
from industnerf.reconstruct.load_images import load_images
from industnerf.reconstruct.sources import Selection
from tests.reconstruct import sample_images

CAMERAS = sample_images.cameras()
(FX, _, CX), (_, FY, CY), _ = CAMERAS.K[0].tolist()
W, H = sample_images.WIDTH, sample_images.HEIGHT


def save_photographs(folder: Path) -> None:
    folder.mkdir(parents=True)
    for i, pixels in enumerate(sample_images.images()):
        Image.fromarray(pixels).save(folder / f"{i:03d}.png")


def load(cameras: Path, **selection):
    return load_images(cameras, None, max_size=512, selection=Selection(**selection))


def assert_is_the_set(image_set, atol=1e-12):
    np.testing.assert_array_equal(image_set.rgb, sample_images.images())
    np.testing.assert_allclose(image_set.cameras.K, CAMERAS.K, rtol=1e-12)
    # quaternions of 17 digits, and positions near 10
    np.testing.assert_allclose(image_set.cameras.c2w, CAMERAS.c2w, rtol=0, atol=atol)


def world_to_camera(c2w: np.ndarray) -> list[float]:
    """COLMAP's quaternion (w x y z) and translation."""
    rotation = c2w[:3, :3].T
    quaternion = Rotation.from_matrix(rotation).as_quat(scalar_first=True)
    return [*quaternion.tolist(), *(-rotation @ c2w[:3, 3]).tolist()]


LENSES = {
    "PINHOLE": (1, [FX, FY, CX, CY]),
    "OPENCV": (4, [FX, FY, CX, CY, 0.0, 0.0, 0.0, 0.0]),
    "FULL_OPENCV": (6, [FX, FY, CX, CY, *[0.0] * 8]),
}


def write_colmap(model: Path, binary: bool, lens: str = "PINHOLE", points: int = 2) -> Path:
    """Images in the order 4 .. 0, each with some points, as the writer of COLMAP has them."""
    model.mkdir(parents=True)
    number, params = LENSES[lens]
    poses = [(i, world_to_camera(CAMERAS.c2w[i]), f"{i:03d}.png") for i in reversed(range(5))]
    if binary:
        head = struct.pack("<QIiQQ", 1, 7, number, W, H)
        (model / "cameras.bin").write_bytes(head + struct.pack(f"<{len(params)}d", *params))
        body = struct.pack("<Q", len(poses))
        for i, pose, name in poses:
            body += struct.pack("<I7dI", i + 1, *pose, 7) + name.encode() + b"\0"
            body += struct.pack("<Q", points) + struct.pack("<ddq", 1.5, 2.5, -1) * points
        (model / "images.bin").write_bytes(body)
        return model
    (model / "cameras.txt").write_text(
        f"# Camera list\n7 {lens} {W} {H} {' '.join(map(repr, params))}\n"
    )
    lines = ["# Image list", "# two lines each"]
    for i, pose, name in poses:
        lines += [f"{i + 1} {' '.join(map(repr, pose))} 7 {name}", "1.5 2.5 -1 " * points]
    (model / "images.txt").write_text("\n".join(lines) + "\n")
    return model


@pytest.mark.parametrize("binary", [True, False])
@pytest.mark.parametrize("lens", LENSES)
@pytest.mark.parametrize("points", [0, 2])
def test_a_model_of_colmap_is_read(tmp_path, binary, lens, points):
    save_photographs(tmp_path / "images")
    model = write_colmap(tmp_path / "sparse/0", binary, lens, points)
    assert_is_the_set(load(model))


@pytest.mark.parametrize("named", ["", "sparse", "sparse/0", "sparse/0/cameras.bin"])
def test_a_model_is_found_from_the_project_down_to_a_file(tmp_path, named):
    save_photographs(tmp_path / "images")
    write_colmap(tmp_path / "sparse/0", binary=True)
    assert_is_the_set(load(tmp_path / named))


@pytest.mark.parametrize(
    ("lens", "params"),
    [
        ((0, "SIMPLE_PINHOLE"), {"f": 50.0, "cx": CX, "cy": CY}),
        ((2, "SIMPLE_RADIAL"), {"f": 50.0, "cx": CX, "cy": CY, "k1": 0.1}),
        ((3, "RADIAL"), {"f": 50.0, "cx": CX, "cy": CY, "k1": 0.1, "k2": 0.2}),
    ],
)
@pytest.mark.parametrize("binary", [True, False])
def test_lenses_of_colmap_are_those_of_opencv(tmp_path, monkeypatch, lens, params, binary):
    monkeypatch.setitem(LENSES, lens[1], (lens[0], list(params.values())))
    frames = read_camera_file(write_colmap(tmp_path / "0", binary, lens[1])).frames
    shared = {key: value for key, value in params.items() if key != "f"}
    expected = {"fl_x": 50.0, "fl_y": 50.0, "w": W, "h": H} | shared
    assert all(frame.camera_params == expected for frame in frames)
    assert [frame.name for frame in frames] == [f"{i:03d}.png" for i in range(5)]


@pytest.mark.parametrize("binary", [True, False])
def test_another_lens_is_named_with_the_command_that_undistorts(tmp_path, monkeypatch, binary):
    monkeypatch.setitem(LENSES, "OPENCV_FISHEYE", (5, LENSES["OPENCV"][1]))
    model = write_colmap(tmp_path / "0", binary, "OPENCV_FISHEYE")
    with pytest.raises(BadArtifact, match=r"camera model .*colmap image_undistorter"):
        read_camera_file(model)


def test_a_torn_model_is_refused(tmp_path):
    model = write_colmap(tmp_path / "0", binary=True)
    data = (model / "images.bin").read_bytes()
    for cut in (0, 4, 30, len(data) - 60):
        (model / "images.bin").write_bytes(data[:cut])
        with pytest.raises(BadArtifact, match="torn, or no file of a COLMAP model"):
            read_camera_file(model)


def test_the_largest_of_several_models_is_taken_and_the_others_are_said(tmp_path):
    save_photographs(tmp_path / "images")
    write_colmap(tmp_path / "sparse/1", binary=True)
    small = write_colmap(tmp_path / "sparse/0", binary=False)
    lines = (small / "images.txt").read_text().splitlines()
    (small / "images.txt").write_text("\n".join(lines[:6]) + "\n")
    image_set = load(tmp_path / "sparse")
    assert_is_the_set(image_set)
    assert "COLMAP made 2 models that do not join" in image_set.warnings[0]


def write_sdfstudio(folder: Path, **changes) -> Path:
    save_photographs(folder / "images")
    K = np.eye(4)
    K[:3, :3] = CAMERAS.K[0]
    frames = [
        {"rgb_path": f"{i:03d}.png", "camtoworld": c2w.tolist(), "intrinsics": K.tolist()}
        for i, c2w in enumerate(CAMERAS.c2w)
    ]
    content = {"camera_model": "OPENCV", "height": H, "width": W, "frames": frames} | changes
    return sample_images.write_json_file(folder / "meta_data.json", content)


def test_meta_data_of_sdfstudio_is_read(tmp_path):
    assert_is_the_set(load(write_sdfstudio(tmp_path)))


def test_worldtogt_leads_back(tmp_path):
    to_truth = np.diag([2.0, 2, 2, 1])
    to_truth[:3, 3] = [5, 6, 7]
    path = write_sdfstudio(tmp_path, worldtogt=to_truth.tolist())
    assert any("worldtogt not undone" in warning for warning in load(path).warnings)
    image_set = load(path, undo_transform=True)
    centers = CAMERAS.c2w[:, :3, 3] * 2 + [5, 6, 7]
    np.testing.assert_allclose(image_set.cameras.centers, centers, atol=1e-12)
    np.testing.assert_allclose(image_set.cameras.c2w[:, :3, :3], CAMERAS.c2w[:, :3, :3], atol=1e-12)


APPLIED = np.array([[0.0, 1, 0, 0.5], [1, 0, 0, -2], [0, 0, -1, 3]])


def write_moved(folder: Path, scale: float | None) -> Path:
    """transforms.json as nerfstudio moves poses: x became scale * (A x + t)."""
    path = sample_images.write_image_set(folder)
    content = json.loads(path.read_text())
    for frame in content["frames"]:
        moved = np.vstack([APPLIED, [0, 0, 0, 1]]) @ np.array(frame["transform_matrix"])
        moved[:3, 3] *= scale or 1.0
        frame["transform_matrix"] = moved.tolist()
    content["applied_transform"] = APPLIED.tolist()
    content |= {} if scale is None else {"applied_scale": scale}
    return sample_images.write_json_file(path, content)


@pytest.mark.parametrize("scale", [None, 0.01])
def test_an_applied_transform_is_said_and_undone_on_request(tmp_path, scale):
    path = write_moved(tmp_path, scale)
    (warning,) = load(path).warnings
    assert warning.startswith("applied_transform")
    assert ("applied_scale 0.01" in warning) == (scale is not None)
    assert "--undo-transform gives the frame before" in warning
    image_set = load(path, undo_transform=True)
    assert_is_the_set(image_set)
    assert "undone: the cloud is in the frame before it" in image_set.warnings[0]


def test_there_may_be_nothing_to_undo(tmp_path):
    path = sample_images.write_image_set(tmp_path)
    image_set = load(path, undo_transform=True)
    assert_is_the_set(image_set)
    assert "says of no transform" in image_set.warnings[0]


def test_a_matrix_of_three_rows_is_read(tmp_path):
    path = sample_images.write_image_set(tmp_path)
    content = json.loads(path.read_text())
    for frame in content["frames"]:
        del frame["transform_matrix"][3]
    assert_is_the_set(load(sample_images.write_json_file(path, content)))


def test_the_folder_of_a_blender_scene_is_enough(tmp_path):
    path = sample_images.write_image_set(tmp_path)
    path.rename(tmp_path / "transforms_train.json")
    assert_is_the_set(load(tmp_path))


FOREIGN = {
    "Metashape": (
        b'<?xml version="1.0"?>\n<document version="2.0.0"><chunk label="1">',
        "ns-process-data metashape",
    ),
    "RealityCapture": (
        b"#name,x,y,alt,heading,pitch,roll,f,px,py,k1\r\na.jpg,1,",
        "ns-process-data realitycapture",
    ),
    "BlocksExchange": (b'<?xml version="1.0"?>\n<BlocksExchange version="3.2">', "export COLMAP"),
    "database of COLMAP": (b"SQLite format 3\0\x10", "colmap mapper --database_path"),
    "Bundler": (b"# Bundle file v0.3\n5 100\n", "export COLMAP"),
    "VisualSFM": (b"NVM_V3 \n\n5\n", "export COLMAP"),
    "Pix4D": (b"fileName imageWidth imageHeight \n", "export COLMAP"),
    "LLFF": (b"\x93NUMPY\x01\x00v\x00", "sparse/0"),
    "OpenMVG": (
        b'{"sfm_data_version": "0.3", "views": [], "extrinsics": []}',
        "openMVG_main_openMVG2Colmap -i",
    ),
    "Meshroom": (
        b'{"version": ["1", "2"], "views": [], "intrinsics": [], "poses": []}',
        "aliceVision_exportColmap -i",
    ),
    "OpenSfM": (b'[{"cameras": {}, "shots": {}}]', "opensfm export_colmap"),
    "Open3D": (b'{"class_name": "PinholeCameraTrajectory", "parameters": []}', "extrinsic"),
    "Record3D": (b'{"K": [1], "poses": []}', "ns-process-data record3d"),
}


@pytest.mark.parametrize("program", FOREIGN)
def test_the_file_of_another_program_is_named_with_the_way_to_convert_it(tmp_path, program):
    """By what is in it: its name says nothing here."""
    content, remedy = FOREIGN[program]
    path = tmp_path / "my cameras.dat"
    path.write_bytes(content)
    with pytest.raises(BadArtifact) as refusal:
        read_camera_file(path)
    for word in (program, "is not read here", remedy, "--sfm"):
        assert word in str(refusal.value)
    if "{path}" in remedy or " -i" in remedy:
        assert shlex.quote(str(path)) in str(refusal.value)  # it can be pasted


@pytest.mark.parametrize("content", [b"", b"\x89PNG\r\n", b"hello\n", b"{]"])
def test_a_file_of_no_known_kind_is_refused(tmp_path, content):
    (tmp_path / "a.json").write_bytes(content)
    with pytest.raises(BadArtifact, match="is not readable JSON"):
        read_camera_file(tmp_path / "a.json")


def test_axes_of_frames_are_those_of_transforms_json(tmp_path):
    """The one convention behind all readers."""
    moved = replace(CAMERAS, c2w=CAMERAS.c2w @ OPENGL)
    frames = read_camera_file(write_colmap(tmp_path / "0", binary=True)).frames
    np.testing.assert_allclose([frame.matrix for frame in frames], moved.c2w, atol=1e-12)
