"""Meshes and clouds in the formats of meshes."""

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.ply import write_ply
from industnerf.errors import BadArtifact
from industnerf.external.points import read_cloud

POINTS = np.random.default_rng(0).normal(size=(20_000, 3))
CORNER = "0 0 0\n1 0 0\n0 1 0\n"
PLY = (
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
)


DRAWN = "500 points are drawn of it, evenly by area"


def read_file(path):
    content = read_cloud(path, 500, np.random.default_rng(0))
    return content.points, list(content.warnings)


def write_obj(path, faces):
    rows = [f"v {x} {y} {z}" for x, y, z in POINTS.tolist()]
    path.write_text("\n".join([*rows, *faces]))


def write_off(path, faces):
    rows = [f"{x} {y} {z}" for x, y, z in POINTS.tolist()]
    path.write_text("\n".join([f"OFF\n{len(POINTS)} {len(faces)} 0", *rows, *faces]))


def test_a_cloud_with_a_single_face_is_a_cloud(tmp_path):
    write_ply(tmp_path / "a.ply", POINTS, faces=np.array([[0, 1, 2]], np.int32))
    write_obj(tmp_path / "a.obj", ["f 1 2 3"])
    write_off(tmp_path / "a.off", ["3 0 1 2"])
    for name in ("a.ply", "a.obj", "a.off"):
        points, (warning,) = read_file(tmp_path / name)
        np.testing.assert_allclose(points, POINTS, atol=1e-6)  # PLY is float32
        assert "19997 of its 20000 vertices belong to no face" in warning
        assert "without its faces (1)" in warning


def test_clouds_without_a_face_are_read_from_obj_and_off_too(tmp_path):
    write_obj(tmp_path / "a.obj", [])
    write_off(tmp_path / "a.off", [])
    for name in ("a.obj", "a.off"):
        points, warnings = read_file(tmp_path / name)
        np.testing.assert_allclose(points, POINTS)
        assert warnings == []


def test_a_mesh_with_a_vertex_too_many_is_a_mesh(tmp_path):
    (tmp_path / "a.off").write_text(f"OFF\n4 1 0\n{CORNER}9 9 9\n3 0 1 2\n")
    points, warnings = read_file(tmp_path / "a.off")
    assert (len(points), points.max() < 1) == (500, True)
    assert warnings == [
        "1 of its 4 vertices belong to no face and do not count",
        f"a mesh of 1 faces: {DRAWN}",
    ]


def test_what_is_the_matter_with_a_mesh_is_said_by_name(tmp_path):
    (tmp_path / "index.ply").write_text(f"{PLY}{CORNER}3 0 1 7\n")
    (tmp_path / "short.ply").write_text(f"{PLY.replace('vertex 3', 'vertex 300')}{CORNER}")
    vertices = "".join(f"v {row}\n" for row in CORNER.splitlines())
    (tmp_path / "nan.obj").write_text(f"{vertices}v nan 0 0\nf 1 2 3\nf 1 2 4\n")
    (tmp_path / "index.obj").write_text(f"{vertices}f 1 2 9\n")
    (tmp_path / "flat.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n")
    trimesh.creation.box().export(tmp_path / "whole.stl")
    (tmp_path / "short.stl").write_bytes((tmp_path / "whole.stl").read_bytes()[:300])
    (tmp_path / "empty.stl").touch()
    for name, reason in (
        ("index.ply", r"1 of 1 faces name a vertex that is not there; .* \[0, 1, 7\] of 3"),
        ("short.ply", "cut short"),
        ("nan.obj", "1 of its 2 faces have a corner that is not finite"),
        ("index.obj", "line 4, 'f 1 2 9': vertex 9, and so far there are 3"),
        ("flat.off", "a mesh of 1 faces and no area"),
        ("short.stl", "header promises 12 triangles, the file holds 4: it is cut short"),
        ("empty.stl", "the file is empty"),
    ):
        with pytest.raises(BadArtifact, match=f"{name} cannot be read: .*{reason}"):
            read_file(tmp_path / name)


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_a_line_of_an_obj_that_goes_on_counts_as_those_it_takes(tmp_path, end):
    lines = ["v 0 0 0", "v 1 \\", "  0 \\", "0", "v 0 1 0", "f 1 \\", "2 9"]
    (tmp_path / "a.obj").write_bytes(end.join(lines).encode())
    with pytest.raises(BadArtifact, match=r"line 6, 'f 1  2 9': vertex 9, and so far there are 3"):
        read_file(tmp_path / "a.obj")
    (tmp_path / "b.obj").write_bytes(end.join([*lines[:-1], "2 3 \\"]).encode())
    assert len(read_file(tmp_path / "b.obj")[0]) == 500


def test_faces_that_are_lines_are_dropped_with_a_word(tmp_path):
    write_obj(tmp_path / "a.obj", ["f 1 2", "f 3"])
    points, warnings = read_file(tmp_path / "a.obj")
    np.testing.assert_allclose(points, POINTS)
    assert warnings == ["faces of fewer than 3 corners dropped: 2"]


def test_faces_whose_area_overflows_are_refused_with_their_largest_coordinate(tmp_path):
    far = CORNER.replace("0 1 0", "0 -1e200 0")
    (tmp_path / "a.off").write_text(f"OFF\n4 2 0\n{CORNER}0 -1e200 0\n3 0 1 2\n3 0 1 3\n")
    (tmp_path / "b.off").write_text(f"OFF\n3 1 0\n{far}3 0 1 2\n")
    for name, count in (("a.off", "1 of its 2"), ("b.off", "1 of its 1")):
        with pytest.raises(BadArtifact, match=rf"{count} faces .* too large: .* -1e\+200, and"):
            read_file(tmp_path / name)


def test_what_a_reader_remarks_on_is_said(tmp_path):
    trimesh.creation.box().export(tmp_path / "a.stl", file_type="stl_ascii")
    text = (tmp_path / "a.stl").read_text()
    (tmp_path / "a.stl").write_text(text.replace("endsolid", ""))
    assert read_file(tmp_path / "a.stl")[1] == [
        "the text does not end with `endsolid`: it may be cut short",
        f"a mesh of 12 faces: {DRAWN}",
    ]
