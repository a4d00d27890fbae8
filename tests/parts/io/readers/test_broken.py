"""The nasty cases of ../shared/cad/nasty, made by hand: a right load or one clear sentence."""

import json
import struct

import numpy as np
import pytest

from industnerf.errors import BadPart
from tests.parts.io.readers import samples
from tests.parts.io.readers.samples import CORNERS, FACES, SAMPLES


def truncated(name, share=2 / 3):
    return SAMPLES[name][: int(share * len(SAMPLES[name]))]


def off_of_eight(corners):
    """A box's corners, and one face with `corners`."""
    rows = [f"{x} {y} {z}" for x, y, z in CORNERS]
    return "\n".join(["OFF", "8 1", *rows, f"8 {corners}"]).encode()


def glb_of_points():
    """The corners of a box, and no face."""
    tree, data = samples.gltf_tree()
    tree["meshes"] = [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 0}]}]
    return samples.glb(tree, data)


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        (
            "cut.stl",
            samples.binary_stl()[:-100],
            "header promises 12 triangles, the file holds 10: it is cut short",
        ),
        ("huge.stl", samples.binary_stl(count=2**32 - 1), "header promises 4294967295 triangles"),
        ("text.stl", b"this is no mesh at all\n" * 9, "no STL: neither `solid` and `facet`"),
        ("short.stl", b"\0" * 40, "40 bytes, and the header alone has 84"),
        ("none.stl", b"solid x\nendsolid x", "text STL: no face in the file"),
        ("zero.stl", samples.binary_stl(faces=FACES[:0]), "binary STL: no face in the file"),
        ("words.stl", samples.text_stl(number="x{}"), "a vertex is no number"),
        (
            "points.obj",
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\n",
            "OBJ: no face in the file, but 3 points: it is a cloud, no mesh",
        ),
        ("far.obj", b"v 0 0 0\nv 1 0 0\nf 1 2 3\n", "line 3, 'f 1 2 3': vertex 3, and so far"),
        ("on.obj", b"v 0 0 0\nv 1 \\\n0 \\\r\n0\nf 1 2 \\\n9\n", "line 5, 'f 1 2 9': vertex 9"),
        ("zero.obj", b"v 0 0 0\nf 0 0 0\n", "line 2, 'f 0 0 0': vertex 0"),
        ("number.obj", b"v 0 zero 0\n", "line 1, 'v 0 zero 0': could not convert"),
        ("flat.obj", b"v 0 0\n", "a vertex has three coordinates"),
        ("far.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "OFF: 1 of 1 faces name"),
        ("eight.off", off_of_eight("0 1 2 -1 4 5 6 7"), "[0, 1, 2, -1, 4, 5, 6, 7] of 8"),
        (
            "few.off",
            b"OFF\n3 4\n0 0 0\n1 0 0\n0 1 0\n",
            "promises 3 vertices and 4 faces, and has 3",
        ),
        ("two.off", b"OFF\n3 1\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "a face promises 2 corners"),
        ("four.off", b"4OFF\n1 1 1\n", "only text OFF and COFF are read"),
        ("points.off", b"OFF\n2 0\n0 0 0\n1 0 0\n", "no face in the file, but 2 points: it is a"),
        (
            "points.ply",
            samples.ply(text=True, faces=0, vertices=8),
            "PLY: no face in the file, but 8 points: it is a cloud, no mesh",
        ),
        (
            "points.glb",
            glb_of_points(),
            "GLB: no face in the file, but 8 points: it is a cloud, no mesh; points and lines",
        ),
        ("scan.pcd", b"# .PCD v0.7\n", ".pcd is a cloud of points, which has no face and is no"),
        ("bare.off", b"OFF\n", "list index out of range"),
        ("empty.ply", samples.ply(text=True, faces=0, vertices=0), "PLY: no face in the file"),
        (
            "count.ply",
            samples.ply(faces=4_000_000_000),
            "promises 8 vertex rows and 4000000000 face",
        ),
        ("text.ply", samples.ply(text=True, vertices=2**40), "it is cut short"),
        ("word.ply", b"ply\nformat ascii 1.0\nelement vertex zwei\nend_header\n", "is no count"),
        ("head.ply", b"ply\nformat ascii 1.0\n", "its header has no end"),
        (
            "cut.glb",
            truncated("box.glb"),
            "header promises 1036 bytes, the file holds 690: it is cut",
        ),
        ("one.glb", struct.pack("<4sII", b"glTF", 1, 20) + b"\0" * 8, "version 1"),
        ("cut.3mf", truncated("box.3mf"), "its archive cannot be unpacked"),
        ("unit.3mf", samples.threemf(unit="ell"), "unit 'ell' is none of micron"),
        ("gone.3mf", samples.threemf(build='<item objectid="9"/>'), "object '9' is built, but not"),
        ("cut.dae", truncated("box.dae"), "not readable as COLLADA"),
        ("cut.zae", truncated("box.zae"), "its archive cannot be unpacked"),
        ("cut.3dxml", truncated("box.3dxml"), "its archive cannot be unpacked"),
        ("empty.3dxml", samples.zipped({"Manifest.xml": "<a/>"}), "which it names, is not in the"),
    ],
)
def test_what_cannot_be_read_is_refused_in_one_sentence(read, name, content, expected):
    with pytest.raises(BadPart) as refused:
        read(name, content)
    message = str(refused.value)
    assert message.startswith(f"{name}: ")
    assert expected in message
    assert "\n" not in message
    assert "Traceback" not in message


def test_a_tail_is_ignored_with_a_warning(read):
    solids = read("tail.stl", samples.binary_stl() + b"\0" * 7)
    assert solids.warnings == ("7 bytes after the last triangle ignored",)
    assert len(solids.solids[0].mesh.faces) == 12


def test_decimal_commas_are_read_with_a_warning(read):
    solids = read("commas.stl", samples.text_stl().replace(b".", b","))
    assert solids.warnings == ("decimal commas read as points",)
    np.testing.assert_array_equal(solids.solids[0].mesh.vertices.max(axis=0), (30, 20, 10))


def test_a_text_stl_that_stops_has_a_warning_or_is_refused(read):
    text = samples.text_stl()
    whole = text[: text.rindex(b"facet normal")]
    assert "may be cut short" in read("whole.stl", whole).warnings[0]
    with pytest.raises(BadPart, match="not 3 a face"):
        read("half.stl", text[: text.rindex(b"vertex")])


def test_every_shell_of_a_text_stl_is_a_solid_and_empty_ones_are_passed_over(read):
    content = samples.text_stl("a") + b"solid empty\nendsolid empty\n" + samples.text_stl("b")
    assert [solid.name for solid in read("two.stl", content).solids] == ["a", "b"]


def test_a_facet_without_a_normal_is_a_facet(read):
    content = b"solid x\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
    assert len(read("bare.stl", content + b"endfacet\nendsolid").solids[0].mesh.faces) == 1


def test_vertices_that_are_no_numbers_are_left_to_the_repair(read):
    vertices = CORNERS.copy()
    vertices[0] = np.nan, np.inf, 0
    mesh = read("nan.stl", samples.binary_stl(vertices)).solids[0].mesh
    assert len(mesh.faces) == 12
    assert np.isfinite(mesh.triangles).all(axis=(1, 2)).sum() == 12 - (FACES == 0).any(axis=1).sum()
    with pytest.raises(BadPart, match="no face has three finite corners"):
        read("inf.stl", samples.binary_stl(np.full((8, 3), np.inf)))


def test_obj_negative_indices_count_from_the_end(read):
    corners = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS)
    faces = "".join(f"f {a - 8} {b - 8} {c - 8}\n" for a, b, c in FACES)
    mesh = read("negative.obj", (corners + faces).encode()).solids[0].mesh
    np.testing.assert_array_equal(mesh.vertices[mesh.faces], CORNERS[FACES])


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
def test_obj_in_any_unicode(read, encoding):
    mark = {"utf-16-le": "\ufeff", "utf-16-be": "\ufeff"}.get(encoding, "")
    content = (mark + "# ø\n" + samples.obj().decode()).encode(encoding)
    solids = read("wide.obj", content)
    assert len(solids.solids[0].mesh.faces) == 12
    assert len(solids.finishes) == 2


def test_obj_faces_of_two_corners_are_dropped_and_counted(read):
    content = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1// 2//\nf 1// 2// 3//\n"
    solids = read("stub.obj", content)
    assert solids.warnings == ("faces of fewer than 3 corners dropped: 1",)
    assert len(solids.solids[0].mesh.faces) == 1


def test_obj_lines_may_go_on_in_the_next(read):
    content = b"v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 \\\r\n3\r\n"
    assert len(read("long.obj", content).solids[0].mesh.faces) == 1


def test_obj_without_its_materials_loads_with_a_warning(read):
    solids = read("bare.obj", samples.obj(materials="no where.mtl"))
    assert solids.warnings == ("its materials are missing: no where.mtl",)
    assert [finish.name for finish in solids.finishes] == ["unstated"]


def test_a_dented_polygon_keeps_its_dent(read):
    """An L of area 3 out of a 2 x 2 square; a fan from its first corner would cover the dent."""
    outline = [(2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (0, 0)]
    points = "".join(f"v {x} 7 {y}\n" for x, y in outline)
    mesh = read("l.obj", f"{points}f 1 2 3 4 5 6\n".encode()).solids[0].mesh
    a, b, c = mesh.triangles.swapaxes(0, 1)
    normals = np.cross(b - a, c - a)
    assert len(normals) == 4
    assert np.abs(normals).sum() / 2 == pytest.approx(3)
    assert (normals[:, 1] < 0).all()  # all the way round that the outline goes, seen from -y


def test_a_3mf_color_that_is_missing_is_left_out_with_a_warning(read):
    content = samples.threemf()
    import io
    import zipfile

    model = zipfile.ZipFile(io.BytesIO(content)).read("3D/3dmodel.model")
    wrong = samples.zipped({"3D/3dmodel.model": model.replace(b'p1="1"', b'p1="1000000"')})
    solids = read("color.3mf", wrong)
    assert solids.warnings == ("colors that cannot be resolved are left out",)
    assert [finish.name for finish in solids.finishes] == ["unstated", "#000080"]
    broken = samples.zipped({"3D/3dmodel.model": model.replace(b'v1="0"', b'v1="99"')})
    with pytest.raises(BadPart, match="faces name a vertex that is not there"):
        read("index.3mf", broken)


def test_components_that_hold_themselves_are_refused(read):
    loop = '<object id="5"><components><component objectid="5"/></components></object>'
    with pytest.raises(BadPart, match="holds itself"):
        read("loop.3mf", samples.threemf(extra_objects=loop, build='<item objectid="5"/>'))


def changed_glb(change):
    tree, data = samples.gltf_tree()
    change(tree)
    return samples.glb(tree, data)


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (
            lambda t: t["accessors"][0].update(count=2**40),
            "an accessor promises 1099511627776 rows",
        ),
        (lambda t: t["accessors"][1].pop("bufferView"), "sparse or compressed"),
        (lambda t: t["bufferViews"][0].update(byteLength=10**9), "a view ends at byte 1000000000"),
        (lambda t: t["bufferViews"][0].update(byteStride=0), "an accessor promises"),
        (lambda t: t["nodes"][0].update(children=[0]), "has two parents, or is its own"),
        (lambda t: t["nodes"][0].update(mesh=7), "IndexError"),
        (lambda t: t["buffers"][0].update(uri="gone.bin"), "'gone.bin', which it names, is not"),
        (lambda t: t["buffers"][0].update(uri="data:,base64,???"), "an embedded buffer is broken"),
        (lambda t: t.pop("accessors"), "KeyError: 'accessors'"),
    ],
)
def test_a_glb_whose_counts_do_not_fit_is_refused_before_anything_is_allocated(
    read, change, expected
):
    with pytest.raises(BadPart) as refused:
        read("wrong.glb", changed_glb(change))
    assert expected in str(refused.value)


def test_a_gltf_face_that_names_no_vertex_is_refused(read):
    tree, data = samples.gltf_tree()
    data = data[:96] + b"\xff\xff" + data[98:]
    with pytest.raises(BadPart, match="1 of 10 faces name a vertex that is not there"):
        read("index.glb", samples.glb(tree, data))


def test_a_zip_bomb_is_refused_by_its_promises(read):
    bomb = samples.zipped({"3D/3dmodel.model": b" " * 50_000_000})
    with pytest.raises(BadPart, match="unfolds to 50000000: more than 200 times"):
        read("bomb.3mf", bomb)


@pytest.mark.parametrize("name", ["a.dae", "a.3mf"])
def test_entities_are_refused(read, name):
    text = b'<!DOCTYPE x [<!ENTITY a "aaaaaaaa">]><COLLADA>&a;</COLLADA>'
    content = text if name == "a.dae" else samples.zipped({"3D/3dmodel.model": text})
    with pytest.raises(BadPart, match="declares entities"):
        read(name, content)


# The diagonal is 37.4 and the step of a 32-bit number at x is 2^(floor(log2 x) - 23): at 1e4 it is
# 2.6e-5 of the diagonal, at 1e6 it is 1.7e-3, at 3e7 it is 0.053.
@pytest.mark.parametrize(("offset", "warned"), [(0.0, False), (1e4, False), (1e6, True)])
def test_a_part_far_from_the_origin_in_32_bits_has_a_warning(read, offset, warned):
    warnings = read("far.stl", samples.binary_stl(CORNERS + offset)).warnings
    assert ("32-bit coordinates" in "".join(warnings)) == warned


def test_a_part_too_far_from_the_origin_in_32_bits_is_refused(read):
    with pytest.raises(BadPart, match="the shape is lost; export it near the origin"):
        read("far.stl", samples.binary_stl(CORNERS + 3e7))
    far = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS + 3e7)
    faces = "".join("f {} {} {}\n".format(*(face + 1)) for face in FACES)
    assert read("far.obj", (far + faces).encode()).warnings == ()  # text has digits enough


def test_gltf_with_a_buffer_in_its_folder(read, tmp_path):
    tree, data = samples.gltf_tree(uri="box%20data.bin")
    (tmp_path / "box data.bin").write_bytes(data)
    solids = read("box.gltf", json.dumps(tree).encode())
    assert (solids.format, len(solids.solids[0].mesh.faces)) == ("glTF", 12)
