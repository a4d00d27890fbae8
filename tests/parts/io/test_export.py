"""Exported parts, read back by other programs' eyes: same volume, same box, same colors."""

import json
import struct
import sys
import warnings
from importlib.util import find_spec

import numpy as np
import pytest
import trimesh
from rich.console import Console

from industnerf.artifacts.part import Appearance, Mesh
from industnerf.errors import BadParams, PartsFailed, SuiteError
from industnerf.parts import __main__ as command_line
from industnerf.parts.catalogue.catalogues import CATALOGUE_FOLDERS
from industnerf.parts.catalogue.entries import load_catalogue_mesh, read_catalogue
from industnerf.parts.io.export import export
from industnerf.parts.io.writers.mesh_formats import group_shells_by_solid, srgb_colors
from industnerf.parts.validation import checks

FOLDER = CATALOGUE_FOLDERS["organic"]
ENTRIES = {entry.id: entry for entry in read_catalogue(FOLDER)}
PART = "textured-vase"  # four finishes
QUIET = Console(quiet=True)
needs_cad = pytest.mark.skipif(find_spec("OCP") is None, reason="STEP needs the [cad] extra")


@pytest.fixture(autouse=True)
def serial(monkeypatch):
    """In this process: another one would take seconds to import what it needs."""
    monkeypatch.setenv("INDUSTNERF_RUNNER", "serial")


def read_back(tmp_path, file_format, part_id=PART):
    """What `trimesh` makes of one exported part, and the mesh that went in."""
    export(QUIET, "organic", [part_id], file_format, tmp_path)
    return trimesh.load_scene(
        tmp_path / f"{part_id}.{file_format}", process=False
    ), load_catalogue_mesh(ENTRIES[part_id], FOLDER)


def box(size, at=0.0, is_void=False):
    """A cube of `size` mm about (at, at, at), inside out if it is a void."""
    cube = trimesh.creation.box((size, size, size))
    corners = np.asarray(cube.faces, np.int32)
    return np.asarray(cube.vertices) + at, corners[:, ::-1] if is_void else corners


def concatenated(*bodies):
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in bodies)])
    faces = [faces + start for (_, faces), start in zip(bodies, starts, strict=False)]
    faces = np.concatenate(faces).astype(np.int32)
    return Mesh.with_one_appearance(np.concatenate([vertices for vertices, _ in bodies]), faces)


@pytest.mark.parametrize("form", ["stl", "ply", "obj"])
def test_triangles_come_back_in_mm(tmp_path, form):
    scene, mesh = read_back(tmp_path, form)
    whole = scene.to_mesh()
    assert len(whole.faces) == len(mesh.faces)
    # STL and PLY are float32: 1e-7 of a coordinate, and the volume's relative error is alike
    expected = checks.volume_mm3(mesh.vertices, mesh.faces)
    assert whole.volume == pytest.approx(expected, rel=1e-5)
    assert whole.extents == pytest.approx(checks.extents_mm(mesh.vertices), rel=1e-6)


def test_glb_comes_back_in_meters_and_y_up(tmp_path):
    scene, mesh = read_back(tmp_path, "glb")
    x, y, z = checks.extents_mm(mesh.vertices) / 1000
    # the quarter turn is a float32 quaternion, good to 1e-7 of the size
    assert scene.to_mesh().extents == pytest.approx([x, z, y], rel=1e-5)
    expected = checks.volume_mm3(mesh.vertices, mesh.faces) / 1e9
    assert scene.to_mesh().volume == pytest.approx(expected, rel=1e-5)
    assert scene.to_mesh().bounds[0, 1] == pytest.approx(mesh.vertices[:, 2].min() / 1000, abs=1e-6)


def test_glb_has_the_finishes_as_materials(tmp_path):
    """Linear colors, unrounded; trimesh rounds them to 8 bits, so the file itself is read."""
    export(QUIET, "organic", [PART], "glb", tmp_path)
    data = (tmp_path / f"{PART}.glb").read_bytes()
    magic, version, length, size, kind = struct.unpack("<4sIIII", data[:20])
    assert (magic, version, length, kind) == (b"glTF", 2, len(data), 0x4E4F534A)
    tree = json.loads(data[20 : 20 + size])
    finishes = ENTRIES[PART].finishes
    materials = {m["name"]: m["pbrMetallicRoughness"] for m in tree["materials"]}
    assert list(materials) == [finish.name for finish in finishes]
    for finish in finishes:
        assert materials[finish.name] == {
            "baseColorFactor": [*finish.albedo, 1.0],
            "metallicFactor": finish.metallic,
            "roughnessFactor": finish.roughness,
        }
    assert {p["attributes"]["POSITION"] for p in tree["meshes"][0]["primitives"]} == {0}


def test_glb_gives_each_finish_its_faces(tmp_path):
    scene, mesh = read_back(tmp_path, "glb")
    areas = {}
    for body in scene.geometry.values():
        areas[body.visual.material.name] = areas.get(body.visual.material.name, 0) + body.area
    for number, finish in enumerate(ENTRIES[PART].finishes):
        area = checks.area_mm2(mesh.vertices, mesh.faces[mesh.finish == number]) / 1e6
        assert areas[finish.name] == pytest.approx(area, rel=1e-5)


def test_ply_has_a_color_a_face_in_srgb(tmp_path):
    scene, mesh = read_back(tmp_path, "ply")
    (body,) = scene.geometry.values()
    colors = srgb_colors(ENTRIES[PART].finishes)[mesh.finish]
    assert np.array_equal(body.visual.face_colors[:, :3], colors)


def test_obj_names_its_finishes(tmp_path):
    read_back(tmp_path, "obj")
    text = (tmp_path / f"{PART}.mtl").read_text()
    names = [line.split()[1] for line in text.splitlines() if line.startswith("newmtl")]
    colors = [line.split()[1:] for line in text.splitlines() if line.startswith("Kd")]
    finishes = ENTRIES[PART].finishes
    assert names == [finish.name.replace(" ", "_") for finish in finishes]
    # six digits of an 8-bit value
    assert np.array(colors, float) * 255 == pytest.approx(srgb_colors(finishes), abs=1e-3)


def test_colors_are_encoded_for_screens():
    """Closed form: linear 0.2159 is 128 of 255, and the ends stay."""
    grays = [Appearance("gray", (x, x, x), 0.0, 1.0) for x in (0.0, 0.2159, 1.0)]
    assert srgb_colors(tuple(grays))[:, 0].tolist() == [0, 128, 255]


def test_our_own_reader_takes_back_what_was_written(tmp_path):
    from industnerf.parts.io.readers import read_solids

    export(QUIET, "organic", [PART], "obj", tmp_path)
    solids = read_solids(tmp_path / f"{PART}.obj", "mm")
    albedo = {finish.albedo for finish in solids.finishes}
    for finish in ENTRIES[PART].finishes:
        # 8 bits of sRGB: half a level is at most 0.0045 of linear light
        nearest = min(np.abs(np.subtract(finish.albedo, each)).max() for each in albedo)
        assert nearest < 0.0045


def test_our_own_reader_turns_glb_back_to_z_up(tmp_path):
    """The part itself: every face where it was, with its outside outside, in mm."""
    from industnerf.parts.io.readers import read_solids

    export(QUIET, "organic", [PART], "glb", tmp_path)
    (solid,) = read_solids(tmp_path / f"{PART}.glb", "inch").solids
    mesh = load_catalogue_mesh(ENTRIES[PART], FOLDER)
    faces = np.concatenate([mesh.faces[mesh.finish == i] for i in range(mesh.finish.max() + 1)])
    size = np.ptp(mesh.vertices, axis=0).max()
    read = solid.mesh.triangles
    # float32 of coordinates about the size: 6e-8 of it
    np.testing.assert_allclose(read, mesh.vertices[faces], rtol=0, atol=2e-7 * size)


def test_a_void_belongs_to_the_smallest_solid_that_holds_it():
    mesh = concatenated(box(40.0), box(4.0, 0.0, True), box(10.0, 100.0), box(3.0, 100.0, True))
    small, large = group_shells_by_solid(mesh)
    assert [len(shell) for shell in (*small, *large)] == [12] * 4
    for solid, center in ((small, 100.0), (large, 0.0)):
        for shell in solid:
            assert mesh.triangles[shell].mean(axis=(0, 1)) == pytest.approx([center] * 3)
        volumes = [checks.volume_mm3(mesh.vertices, mesh.faces[shell]) for shell in solid]
        assert volumes[0] > 0 > volumes[1]


def test_an_unknown_part_is_named():
    with pytest.raises(BadParams, match=r"no part 'cat' in the set 'organic'.*list --set organic"):
        export(QUIET, "organic", ["cat"], "stl", FOLDER)


@pytest.mark.parametrize(
    ("form", "name"), [("stl", f"{PART}.stl"), ("obj", f"{PART}.obj"), ("obj", f"{PART}.mtl")]
)
def test_a_file_that_is_there_is_left_alone(tmp_path, form, name):
    (tmp_path / name).write_text("mine")
    with pytest.raises(BadParams, match=f"{name} is there already"):
        export(QUIET, "organic", ["textured-fox", PART], form, tmp_path)
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"mine"]


@pytest.mark.parametrize(
    ("below", "message"),
    [("", "is a file; give a folder"), ("sub", "cannot be made: Not a directory")],
)
def test_a_file_as_the_folder_is_refused_and_left_alone(tmp_path, below, message):
    (tmp_path / "mine").write_text("mine")
    with pytest.raises(BadParams, match=f"export: --out .*mine.* {message}"):
        export(QUIET, "organic", [PART], "stl", tmp_path / "mine" / below)
    assert (tmp_path / "mine").read_text() == "mine"


def test_all_is_the_whole_set(tmp_path):
    export(QUIET, "organic", None, "stl", tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {f"{part_id}.stl" for part_id in ENTRIES}


def test_step_without_the_cad_libraries_names_the_extra(tmp_path, monkeypatch):
    monkeypatch.setattr("industnerf.parts.io.export.find_spec", lambda name: None)
    with pytest.raises(SuiteError, match=r"pip install -e '\.\[cad\]'"):
        export(QUIET, "organic", [PART], "step", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_part_that_fails_leaves_no_file_and_the_others_there(tmp_path, monkeypatch):
    original = load_catalogue_mesh

    def torn(entry, folder):
        if entry.id == PART:
            raise BadParams("torn")
        return original(entry, folder)

    monkeypatch.setattr("industnerf.parts.io.export.load_catalogue_mesh", torn)
    with pytest.raises(PartsFailed, match=f"{PART}: torn\n1 parts could not be exported"):
        export(QUIET, "organic", [PART, "textured-fox"], "glb", tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["textured-fox.glb"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "name the parts to export, or give --all"),
        (("--all", PART), "name the parts to export, or give --all"),
        (("cat",), "no part 'cat'"),
    ],
)
def test_the_command_line_refuses_in_one_sentence(
    tmp_path, monkeypatch, capsys, arguments, message
):
    argv = ["export", *arguments, "--set", "organic", "--format", "stl", "--out", str(tmp_path)]
    monkeypatch.setattr(sys, "argv", ["parts", *argv])
    assert command_line.main() == 2
    assert message in capsys.readouterr().err


def test_the_command_line_lists_what_it_wrote(tmp_path, monkeypatch, capsys):
    argv = ["export", PART, "--set", "organic", "--format", "ply", "--out", str(tmp_path)]
    monkeypatch.setattr(sys, "argv", ["parts", *argv])
    assert command_line.main() == 0
    assert "1 parts written" in capsys.readouterr().out


# --- STEP ----------------------------------------------------------------------------------


def solids_in(path):
    """(name, volume, box, linear color) of each solid, as OpenCASCADE reads them."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from build123d import import_step

        read = import_step(path)
    leaves = [each for each in (read, *read.descendants) if not each.children]
    return [(leaf.label, leaf.volume, leaf.bounding_box().size, leaf.color) for leaf in leaves]


@needs_cad
@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_an_exact_drawing_keeps_names_colors_and_volume(tmp_path):
    from build123d import Cylinder, Pos, Sphere

    from industnerf.parts.catalogue.appearances import APPEARANCES
    from industnerf.parts.catalogue.recipe import Assembly
    from industnerf.parts.io.writers.step import write_drawing

    bodies = {"steel": Cylinder(10, 40), "brass": Pos(0, 0, 50) * Sphere(8)}
    write_drawing(tmp_path / "pin.step", Assembly(bodies))
    exact = {"steel": np.pi * 100 * 40, "brass": 4 / 3 * np.pi * 512}
    solids = solids_in(tmp_path / "pin.step")
    assert {name for name, *_ in solids} == set(exact)
    for name, volume, _, color in solids:
        assert volume == pytest.approx(exact[name], rel=1e-6)  # exact surfaces, no facets
        # OpenCASCADE keeps colors in float32 and the file in sRGB with twelve digits
        assert tuple(color)[:3] == pytest.approx(APPEARANCES[name].albedo, abs=1e-5)


@needs_cad
@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_facets_keep_volume_and_box(tmp_path):
    export(QUIET, "organic", ["textured-fox"], "step", tmp_path)
    (path,) = tmp_path.iterdir()
    assert path.name == "textured-fox-faceted.step"
    ((_, volume, size, _),) = solids_in(path)
    properties = ENTRIES["textured-fox"].measured
    assert volume == pytest.approx(properties.volume_mm3, rel=1e-9)
    assert tuple(size) == pytest.approx(
        properties.extents_mm, abs=1e-3
    )  # OpenCASCADE's box has slack


@needs_cad
@pytest.mark.slow
def test_facets_keep_the_color_of_each_face(tmp_path):
    from industnerf.parts.io.readers import read_solids

    export(QUIET, "organic", ["textured-fox"], "step", tmp_path)
    mesh, entry = load_catalogue_mesh(ENTRIES["textured-fox"], FOLDER), ENTRIES["textured-fox"]
    solids = read_solids(tmp_path / "textured-fox-faceted.step", "mm")
    (solid,) = solids.solids
    for number, finish in enumerate(entry.finishes):
        color_errors = [
            np.abs(np.subtract(finish.albedo, each.albedo)).max() for each in solids.finishes
        ]
        nearest = int(np.argmin(color_errors))
        assert color_errors[nearest] < 0.0045  # 8 bits of sRGB
        area = checks.area_mm2(mesh.vertices, mesh.faces[mesh.finish == number])
        read = solid.mesh.faces[solid.mesh.finish == nearest]
        assert checks.area_mm2(solid.mesh.vertices, read) == pytest.approx(area, rel=1e-9)


@needs_cad
@pytest.mark.slow
def test_facets_keep_bodies_and_voids(tmp_path):
    from industnerf.parts.io.writers.step import write_faceted

    mesh = concatenated(box(40.0), box(4.0, 0.0, True), box(10.0, 100.0))
    write_faceted(tmp_path / "two.step", mesh, (Appearance("steel", (0.5, 0.5, 0.5), 1.0, 0.3),))
    volumes = sorted(volume for _, volume, *_ in solids_in(tmp_path / "two.step"))
    assert volumes == pytest.approx([1000.0, 64000.0 - 64.0], rel=1e-9)


@needs_cad
@pytest.mark.slow
def test_too_many_facets_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("industnerf.parts.io.writers.step.MAX_FACETS", 100)
    with pytest.raises(PartsFailed, match="1956 facets, and a STEP file of more than 100"):
        export(QUIET, "organic", ["textured-fox"], "step", tmp_path)
    assert not list(tmp_path.iterdir())
