"""One box in every format is one box; and content decides what a file is."""

import gzip

import numpy as np
import pytest

from industnerf.errors import BadPart
from industnerf.parts.io.readers.formats import FORMATS, SUFFIXES, detect_by_content, detect_format
from industnerf.parts.validation.checks import bad_edges, volume_mm3
from tests.parts.io.readers.samples import BLUE, RED, SAMPLES, SIZE, binary_stl, ply, text_stl


@pytest.mark.parametrize("name", SAMPLES)
def test_a_box_in_any_format_is_a_box(read, name):
    solids = read(name, SAMPLES[name])
    assert solids.file == name
    assert solids.warnings == ()
    (solid,) = solids.solids
    corners = solid.mesh.vertices[solid.mesh.faces]
    # glTF and COLLADA keep meters as 32-bit numbers: 6e-8 of the size, three times in the volume
    assert np.ptp(corners.reshape(-1, 3), axis=0) == pytest.approx(SIZE, rel=1e-7)
    assert volume_mm3(solid.mesh.vertices, solid.mesh.faces) == pytest.approx(6000, rel=2e-7)


@pytest.mark.parametrize("name", [name for name in SAMPLES if not name.endswith("stl")])
def test_a_face_keeps_its_own_color(read, name):
    """Red above and blue elsewhere, whatever order the reader brings the faces in."""
    solids = read(name, SAMPLES[name])
    mesh = solids.solids[0].mesh
    assert [finish.name for finish in solids.finishes] == ["#000080", "#ff0000"]
    on_top = (mesh.triangles[:, :, 2] > 9.99).all(axis=1)
    np.testing.assert_array_equal(mesh.finish, on_top)
    assert BLUE == (0, 0, 128)
    assert RED == (255, 0, 0)
    # the sRGB decoding of 128/255, by hand: ((128/255 + 0.055) / 1.055)^2.4
    assert solids.finishes[0].albedo == pytest.approx((0, 0, 0.215861), abs=1e-6)


def test_indexed_formats_stay_indexed_and_closed(read):
    mesh = read("box.off", SAMPLES["box.off"]).solids[0].mesh
    assert len(mesh.vertices) == 8
    assert not len(bad_edges(mesh.faces))


@pytest.mark.parametrize("name", SAMPLES)
def test_content_alone_tells_the_format(tmp_path, name):
    path = tmp_path / f"{name}.unknown"
    path.write_bytes(SAMPLES[name])
    expected = SUFFIXES[f".{name.rpartition('.')[2]}"]
    detected, warnings = detect_format(path)
    assert detected == expected
    assert "its content is" in warnings[0]


def test_content_wins_over_the_name_with_a_remark(read):
    solids = read("part.step", SAMPLES["binary.stl"])
    assert solids.format == "binary STL"
    assert solids.warnings == ("named .step, but its content is STL",)
    assert read("part.obj", SAMPLES["box.3mf"]).format == "3MF"


@pytest.mark.parametrize("header", [b"solid facet normal of a liar", b"ply to stl", b"glTF to stl"])
def test_the_header_of_a_binary_stl_may_say_anything(read, header):
    solids = read("part.stl", binary_stl(header=header))
    assert (solids.format, len(solids.solids[0].mesh.faces)) == ("binary STL", 12)


@pytest.mark.parametrize(
    ("head", "name"),
    [
        (b"ISO-10303-21;\nHEADER;", "STEP"),
        (b"/* a remark */ ISO-10303-21;", "STEP"),
        (b"DBRep_DrawableShape\n\nCASCADE Topology V1, (c) Matra", "BREP"),
        (b"\nCASCADE Topology V3, (c) Open Cascade", "BREP"),
        (b"an IGES file".ljust(72) + b"S      1\n", "IGES"),
        (b"solid x\nfacet normal", "STL"),
        (b"COFF\n8 6 0\n", "OFF"),
        (b"\xef\xbb\xbf# comment\nv 0 0 0\n", "OBJ"),
        ("# wide\nv 0 0 0\n".encode("utf-16"), "OBJ"),
        (b'{"asset": {"version": "2.0"}}', "glTF"),
        (b"just words", None),
        (b"\0" * 83, None),
        (b"PK\3\4 torn", None),
    ],
)
def test_heads_are_told_apart(tmp_path, head, name):
    (tmp_path / "file").write_bytes(head)
    detected = detect_by_content(tmp_path / "file", head, len(head))
    assert (detected.name if detected else None) == name


def test_what_is_no_cad_at_all_is_named_with_its_suffix(read):
    with pytest.raises(BadPart, match=r"notes\.docx: neither its content nor its name \(\.docx\)"):
        read("notes.docx", gzip.compress(b"words"))
    with pytest.raises(BadPart, match=r"empty\.stl: the file is empty"):
        read("empty.stl", b"")


def test_a_file_that_is_not_there_is_named(read, tmp_path):
    from industnerf.parts.io.readers import read_solids

    with pytest.raises(BadPart, match=r"gone\.stl: cannot be opened: No such file"):
        read_solids(tmp_path / "gone.stl", "mm")
    (tmp_path / "folder.stl").mkdir()
    with pytest.raises(BadPart, match=r"folder\.stl: cannot be opened: Is a directory"):
        read_solids(tmp_path / "folder.stl", "mm")


@pytest.mark.parametrize("suffix", [s for f in FORMATS[:3] for s in f.suffixes])
def test_the_kernels_formats_without_the_kernel_say_how_to_get_it(read, monkeypatch, suffix):
    monkeypatch.setattr("industnerf.parts.io.readers.find_spec", lambda name: None)
    with pytest.raises(BadPart, match=r"needs the CAD kernel.*pip install -e '\.\[cad\]'"):
        read(f"part{suffix}", b"anything")


@pytest.mark.parametrize(("units", "factor"), [("mm", 1), ("cm", 10), ("m", 1000), ("inch", 25.4)])
@pytest.mark.parametrize("name", ["binary.stl", "text.ply", "box.obj", "box.off", "box.3dxml"])
def test_a_file_that_states_no_unit_gets_the_users(read, name, units, factor):
    solids = read(name, SAMPLES[name], units)
    assert solids.unit == f"{units}, assumed"
    assert np.ptp(solids.solids[0].mesh.vertices, axis=0) == pytest.approx(np.array(SIZE) * factor)


@pytest.mark.parametrize("name", ["box.glb", "box.3mf", "box.dae", "box.zae"])
def test_a_file_that_states_its_unit_is_believed(read, name):
    solids = read(name, SAMPLES[name], "inch")
    assert solids.unit.endswith(", stated")
    assert np.ptp(solids.solids[0].mesh.vertices, axis=0) == pytest.approx(SIZE)


def test_doubles_and_text_keep_their_digits(read):
    assert read("a.ply", ply(number="double")).solids[0].mesh.vertices.max() == 30.0
    assert read("b.stl", text_stl(number="{:.17g}")).solids[0].mesh.vertices.max() == 30.0
