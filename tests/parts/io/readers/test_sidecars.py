"""Files beside a file: found where it names them, and nowhere else."""

import json

import pytest

from industnerf.parts.io.readers.sidecars import find_sidecars, resolve_sidecar
from tests.parts.io.readers import samples


@pytest.fixture
def folder(tmp_path):
    for name in ("box.mtl", "my skin.png", "other.mtl", "maps/rust.jpg", "part.bin", "a b.mtl"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(b"")
    (tmp_path / "box.mtl").write_text("newmtl x\nmap_Kd -bm 1 my skin.png\nmap_Ks maps\\rust.jpg\n")
    return tmp_path


def sidecars_of(folder, name, content):
    (folder / name).write_bytes(content)
    return [str(path.relative_to(folder)) for path in find_sidecars(folder / name)]


def test_an_obj_depends_on_its_materials_and_on_their_pictures(folder):
    assert sidecars_of(folder, "box.obj", samples.obj()) == [
        "box.mtl",
        "maps/rust.jpg",
        "my skin.png",
    ]


def test_a_gltf_depends_on_its_buffers(folder):
    tree, _ = samples.gltf_tree(uri="part.bin")
    tree["images"] = [{"uri": "my%20skin.png"}]
    assert sidecars_of(folder, "box.gltf", json.dumps(tree).encode()) == ["my skin.png", "part.bin"]


def test_what_is_not_there_or_not_below_is_no_sidecar(folder):
    inside = folder / "inside"
    inside.mkdir()
    assert sidecars_of(folder, "inside/box.obj", b"mtllib ../box.mtl\nmtllib gone.mtl\n") == []
    assert resolve_sidecar(inside / "box.obj", "/etc/passwd") is None
    (inside / "link.mtl").symlink_to(folder / "box.mtl")
    assert resolve_sidecar(inside / "box.obj", "link.mtl") is None


def test_a_path_of_another_machine_means_the_file_in_the_folder(folder):
    assert resolve_sidecar(folder / "x.obj", r"C:\work\box.mtl") == folder / "box.mtl"
    assert resolve_sidecar(folder / "x.obj", "-o 1 2 a b.mtl") == folder / "a b.mtl"


def test_what_no_file_can_be_called_is_no_sidecar(folder):
    """Two files that ended the whole stage: bytes that look like a name, and a long comment."""
    assert sidecars_of(folder, "box.glb", b"glTF\2\0\0\0 a \0 b wood.png") == []
    comment = "# " + 200 * "\u5bf8" + ".png\nmtllib a b.mtl\n"
    assert sidecars_of(folder, "box.obj", comment.encode()) == ["a b.mtl"]
    assert resolve_sidecar(folder / "x.obj", "\0/wood.png") is None


@pytest.mark.parametrize(
    ("owner", "text", "name"),
    [
        ("box.gltf", '{"asset": 1, "uri": "m\\u00fcll.bin"}', "m\u00fcll.bin"),
        ("box.gltf", '{"asset": 1, "uri": "maps\\/m\u00fcll.bin"}', "maps/m\u00fcll.bin"),
        ("box.obj", "mtllib Bob's.mtl\n", "Bob's.mtl"),
        ("box.obj", "mtllib  two\t words.mtl\n", "two words.mtl"),
        ("box.obj", "mtllib a.mtl b.mtl\n", "b.mtl"),
        ("box.dae", "<COLLADA><init_from>\n a&amp;b.png\n</init_from>", "a&b.png"),
        ("wrong.stl", "mtllib mine.mtl\nv 0 0 0\n", "mine.mtl"),
    ],
)
def test_a_name_is_found_however_its_format_writes_it(folder, owner, text, name):
    (folder / name).write_bytes(b"")
    assert sidecars_of(folder, owner, text.encode()) == [name]


def test_a_name_with_a_delimiter_is_no_sidecar(folder):
    (folder / 'a"b.png').write_bytes(b"")
    assert resolve_sidecar(folder / "x.dae", 'a"b.png') is None


def test_formats_that_name_no_files_have_none(folder):
    assert sidecars_of(folder, "box.stl", b"solid box.mtl") == []
    assert find_sidecars(folder / "gone.obj") == ()
