"""PLY as other programs read it; columns and unit stand in its header."""

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.ply import write_ply

POINTS = np.array([[1.5, -2.0, 3.25], [0.0, 4.0, -1.0], [7.0, 0.5, 0.125]])  # exact in float32
COLORS = np.array([[255, 0, 7], [1, 2, 3], [9, 8, 250]], np.uint8)


def header(path) -> list[str]:
    return path.read_bytes().partition(b"end_header\n")[0].decode().splitlines()


def test_a_cloud_is_read_back(tmp_path):
    write_ply(tmp_path / "a.ply", POINTS, colors=COLORS)
    read = trimesh.load(tmp_path / "a.ply")
    np.testing.assert_array_equal(read.vertices, POINTS)
    np.testing.assert_array_equal(read.colors[:, :3], COLORS)


def test_a_mesh_is_read_back(tmp_path):
    faces = np.array([[0, 1, 2], [2, 1, 0]], np.int32)
    write_ply(tmp_path / "a.ply", POINTS, faces=faces, face_colors=COLORS[:2])
    read = trimesh.load(tmp_path / "a.ply", process=False)
    np.testing.assert_array_equal(read.faces, faces)
    np.testing.assert_array_equal(read.visual.face_colors[:, :3], COLORS[:2])


def test_confidence_and_view_are_columns_and_meshlab_has_its_name(tmp_path):
    confidence, view = np.array([0.0, 0.5, 1.0]), np.array([4, -1, 300], np.int16)
    write_ply(tmp_path / "a.ply", POINTS, confidence=confidence, view=view)
    body = (tmp_path / "a.ply").read_bytes().partition(b"end_header\n")[2]
    rows = np.frombuffer(body, "<f4,<f4,<f4,<f4,<f4,<i2")
    assert rows["f3"].tolist() == rows["f4"].tolist() == [0, 0.5, 1]
    assert rows["f5"].tolist() == [4, -1, 300]
    assert header(tmp_path / "a.ply")[-3:] == [
        "property float confidence",
        "property float quality",
        "property short view",
    ]


@pytest.mark.parametrize(
    ("arguments", "unit_text"), [({}, "mm"), ({"unit": "the cameras' unit"}, "the cameras' unit")]
)
def test_the_header_says_the_unit(tmp_path, arguments, unit_text):
    write_ply(tmp_path / "a.ply", POINTS, **arguments)
    assert f"comment lengths in {unit_text}" in header(tmp_path / "a.ply")
    np.testing.assert_array_equal(trimesh.load(tmp_path / "a.ply").vertices, POINTS)
