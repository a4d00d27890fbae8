"""Files beside a file: found where it names them, and nowhere else."""

import json

import pytest

from industnerf.parts.reading.sidecars import named, sidecars
from tests.parts.reading import samples


@pytest.fixture
def folder(tmp_path):
    for name in ("box.mtl", "my skin.png", "other.mtl", "maps/rust.jpg", "part.bin", "a b.mtl"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(b"")
    (tmp_path / "box.mtl").write_text("newmtl x\nmap_Kd -bm 1 my skin.png\nmap_Ks maps\\rust.jpg\n")
    return tmp_path


def of(folder, name, content):
    (folder / name).write_bytes(content)
    return [str(path.relative_to(folder)) for path in sidecars(folder / name)]


def test_an_obj_depends_on_its_materials_and_on_their_pictures(folder):
    assert of(folder, "box.obj", samples.obj()) == ["box.mtl", "maps/rust.jpg", "my skin.png"]


def test_a_gltf_depends_on_its_buffers(folder):
    tree, _ = samples.gltf_tree(uri="part.bin")
    tree["images"] = [{"uri": "my%20skin.png"}]
    assert of(folder, "box.gltf", json.dumps(tree).encode()) == ["my skin.png", "part.bin"]


def test_what_is_not_there_or_not_below_is_no_sidecar(folder):
    inside = folder / "inside"
    inside.mkdir()
    assert of(folder, "inside/box.obj", b"mtllib ../box.mtl\nmtllib gone.mtl\n") == []
    assert named(inside / "box.obj", "/etc/passwd") is None
    (inside / "link.mtl").symlink_to(folder / "box.mtl")
    assert named(inside / "box.obj", "link.mtl") is None


def test_a_path_of_another_machine_means_the_file_beside(folder):
    assert named(folder / "x.obj", r"C:\work\box.mtl") == folder / "box.mtl"
    assert named(folder / "x.obj", "-o 1 2 a b.mtl") == folder / "a b.mtl"


def test_formats_that_name_no_files_have_none(folder):
    assert of(folder, "box.stl", b"solid box.mtl") == []
    assert sidecars(folder / "gone.obj") == ()
