"""The user's own files: read, mended, or refused in one sentence."""

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.part import load_mesh, load_part
from industnerf.errors import BadParams, BadPart
from industnerf.parts.checks import volume_mm3
from industnerf.parts.clean import clean
from industnerf.parts.ingest import ingest_file
from industnerf.parts.read import read_cad
from industnerf.parts.sources import find_sources, part_ids
from industnerf.schema import PartsParams

SETTINGS = {"units": "mm", "weld": 1e-6, "eyes": 20, "seed": 0}


def params(**changes):
    values = {
        "source": "path",
        "path": ".",
        "pattern": "**/*",
        "units": "mm",
        "select": [],
        "weld": 1e-6,
        "eyes": 20,
    }
    return PartsParams(**(values | changes))


@pytest.fixture
def box():
    return trimesh.creation.box((30, 20, 10))


@pytest.mark.parametrize("suffix", ["stl", "ply", "obj", "off"])
def test_a_box_in_any_format_is_a_box(tmp_path, box, suffix):
    box.export(tmp_path / f"box.{suffix}")
    ingest_file(tmp_path / f"box.{suffix}", "box", "own", tmp_path / "out", **SETTINGS)
    part, mesh = load_part(tmp_path / "out"), load_mesh(tmp_path / "out")
    assert part.extents_mm == pytest.approx((30, 20, 10), rel=1e-6)  # STL is float32
    assert part.volume_mm3 == pytest.approx(6000, rel=1e-6)
    assert part.area_mm2 == pytest.approx(2200, rel=1e-6)
    assert len(mesh.vertices) == 8  # STL's 36 corners are welded
    assert part.visible_share == 1.0  # a convex solid hides nothing
    assert part.defects == ()
    assert part.origin == "file"


def test_glb_is_in_metres(tmp_path, box):
    box.export(tmp_path / "box.glb")
    vertices, _ = read_cad(tmp_path / "box.glb", "mm")
    assert np.ptp(vertices, axis=0) == pytest.approx((30e3, 20e3, 10e3), rel=1e-6)


@pytest.mark.parametrize(("units", "factor"), [("mm", 1), ("cm", 10), ("m", 1000), ("inch", 25.4)])
def test_units_of_a_file_that_states_none(tmp_path, box, units, factor):
    box.export(tmp_path / "box.stl")
    vertices, _ = read_cad(tmp_path / "box.stl", units)
    assert np.ptp(vertices, axis=0) == pytest.approx(np.array((30, 20, 10)) * factor, rel=1e-6)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("empty.stl", b""),
        ("text.stl", b"this is no mesh at all"),
        ("cut.stl", b"\0" * 80 + (1000).to_bytes(4, "little") + b"\0" * 500),
        ("empty.obj", b""),
        ("points.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
        ("broken.ply", b"ply\nformat ascii 1.0\nelement vertex zwei\nend_header\n"),
        ("broken.off", b"OFF\n1 2\n"),
        ("broken.glb", b"glTF\2\0\0\0"),
    ],
)
def test_an_unreadable_file_is_named_with_what_is_wrong(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(BadPart, match=name):
        read_cad(tmp_path / name, "mm")


def test_step_without_the_extra_says_how_to_get_it(tmp_path, monkeypatch):
    monkeypatch.setattr("industnerf.parts.read.find_spec", lambda name: None)
    with pytest.raises(BadPart, match=r"pip install -e '\.\[cad\]'"):
        read_cad(tmp_path / "part.step", "mm")


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")  # the CAD kernel's own
def test_step_comes_in_mm_and_as_fine_as_its_size_asks(tmp_path):
    pytest.importorskip("cascadio")
    build123d = pytest.importorskip("build123d")
    for name, radius in (("small", 0.05), ("large", 500.0)):
        build123d.export_step(build123d.Sphere(radius), str(tmp_path / f"{name}.step"))
        vertices, faces = read_cad(tmp_path / f"{name}.step", "inch")  # STEP states its own unit
        mesh, defects = clean(vertices, faces, 1e-6)
        assert defects == ()
        # a chord error of 5e-4 diagonals of the box, sqrt(12) radii, takes off at most
        # 3 x 5e-4 x sqrt(12) of the volume, and never adds any
        share = volume_mm3(mesh.vertices, mesh.faces) / (4 / 3 * np.pi * radius**3)
        assert 1 - 3 * 5e-4 * np.sqrt(12) < share < 1


def test_faces_with_non_finite_vertices_are_dropped_and_counted(box):
    vertices = np.concatenate([box.vertices, [[np.nan, 0, 0], [np.inf, 0, 0]]])
    faces = np.concatenate([box.faces, [[0, 1, 8], [2, 3, 9]]])
    mesh, defects = clean(vertices, faces, 1e-6)
    assert len(mesh.faces) == 12
    assert defects == ("dropped 2 faces with a non-finite vertex",)


def test_repeated_faces_are_dropped_and_counted(box):
    mesh, defects = clean(box.vertices, np.concatenate([box.faces, box.faces[:3, ::-1]]), 1e-6)
    assert len(mesh.faces) == 12
    assert defects == ("dropped 3 faces that repeat another",)


def test_slivers_stay():
    """A needle triangle carries no area, but dropping it would open the solid."""
    box = trimesh.creation.box((30, 20, 10))
    mesh = box.subdivide()
    vertices = mesh.vertices.copy()
    inner = np.flatnonzero(np.abs(vertices[:, 0]) < 1)
    vertices[inner, 0] = 14.999  # squeezes a row of triangles to a thousandth of a mm
    cleaned, defects = clean(vertices, mesh.faces, 1e-6)
    assert len(cleaned.faces) == len(mesh.faces)
    assert defects == ()


def test_an_inside_out_solid_is_turned(box):
    mesh, defects = clean(box.vertices, box.faces[:, ::-1], 1e-6)
    assert defects == ("turned inside out",)
    assert (
        np.einsum("ij,ij->", mesh.triangles[:, 0], np.cross(*mesh.triangles[:, 1:].swapaxes(0, 1)))
        > 0
    )


def test_an_open_surface_has_no_volume_and_says_so(tmp_path, box):
    box.update_faces(np.arange(12) > 0)
    box.export(tmp_path / "open.stl")
    ingest_file(tmp_path / "open.stl", "open", "own", tmp_path / "out", **SETTINGS)
    part = load_part(tmp_path / "out")
    assert part.volume_mm3 is None
    assert "left 3 edges" in part.defects[0]


@pytest.mark.parametrize("factor", [1e-5, 1.0, 1e6])
def test_welding_does_not_depend_on_size_or_place(box, factor):
    soup = box.triangles.reshape(-1, 3) * factor + np.array([1e3, -2e3, 5e2]) * factor
    mesh, defects = clean(soup, np.arange(36).reshape(-1, 3), 1e-6)
    assert len(mesh.vertices) == 8
    assert defects == ()


@pytest.mark.parametrize(
    ("vertices", "said"),
    [
        (np.zeros((3, 3)), "diagonal of 0.0 mm"),
        (np.eye(3), "1 distinct faces"),
        (np.full((3, 3), np.nan), "no face has finite vertices"),
    ],
)
def test_what_is_no_solid_is_refused(vertices, said):
    with pytest.raises(BadPart, match=said):
        clean(vertices, np.array([[0, 1, 2]]), 1e-6)


def test_ids_come_from_paths_and_tell_types_apart(tmp_path):
    names = ["A b.stl", "sub/A b.stl", "sub/c.STL", "sub/c.obj"]
    ids = part_ids(tmp_path, [tmp_path / name for name in names])
    assert ids == ["a-b", "sub-a-b", "sub-c-stl", "sub-c-obj"]
    with pytest.raises(BadParams, match="share the id"):
        part_ids(tmp_path, [tmp_path / "a-b.stl", tmp_path / "a b.stl"])


def test_a_folder_without_cad_is_named(tmp_path):
    (tmp_path / "readme.txt").touch()
    with pytest.raises(BadParams, match=r"parts\.path: no file in .* ends in \.step"):
        find_sources(tmp_path, params(), 0)
    with pytest.raises(BadParams, match=r"set parts\.source: path"):
        find_sources(tmp_path, params(source="embedded"), 0)
    with pytest.raises(BadParams, match="is not a folder"):
        find_sources(tmp_path / "nowhere", params(), 0)


def test_select_keeps_what_it_names_and_refuses_what_is_not_there(tmp_path):
    for name in ("a.stl", "b.stl"):
        (tmp_path / name).touch()
    assert [s.part_id for s in find_sources(tmp_path, params(select=["b"]), 0)] == ["b"]
    with pytest.raises(BadParams, match=r"parts\.select: 'c' is not among a, b"):
        find_sources(tmp_path, params(select=["c"]), 0)
