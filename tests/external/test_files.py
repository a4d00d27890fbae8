"""Which file is a cloud of which part."""

from pathlib import Path

import pytest
import trimesh

from industnerf.config import load_params
from industnerf.errors import BadParams
from industnerf.external.files import cad_file, find_clouds, select_catalogue, user_cad
from industnerf.parts.catalogue.entries import EMBEDDED_FOLDER
from tests import solids
from tests.conftest import ROOT

PARTS = load_params(ROOT / "params.yaml").parts
GEAR, VASE = "gear-spur-m2-z24", "organic-coral"


@pytest.fixture
def folder(tmp_path):
    for name in (f"{GEAR}.ply", "nut-square-din557-m12.xyz", "notes.txt", f"._{GEAR}.ply"):
        (tmp_path / name).touch()
    (tmp_path / "old.ply").mkdir()
    return tmp_path


def test_files_of_a_folder_are_named_after_their_parts(folder, capsys):
    (folder / "scan.las").touch()
    (folder / "sizes.csv").write_text("name,size\ngear,24\n")
    (folder / "rack-m2-z16.csv").write_text("id,x,y,z\n7,1,2,3\n")
    clouds = find_clouds(folder, "")
    assert {part: path.name for part, path in clouds.items()} == {
        GEAR: f"{GEAR}.ply",
        "nut-square-din557-m12": "nut-square-din557-m12.xyz",
        "rack-m2-z16": "rack-m2-z16.csv",
    }
    assert capsys.readouterr().out == (
        "left out, for they are no clouds that are read: notes.txt, scan.las, sizes.csv\n"
        "scan.las: it is LAS, which is not read: `pdal translate scan.las scan.ply`\n"
    )


def test_a_format_that_is_not_read_is_named_with_its_converter(tmp_path):
    (tmp_path / "scan.laz").touch()
    with pytest.raises(BadParams, match=r"scan\.laz: it is LAZ, .* `pdal translate scan\.laz scan"):
        find_clouds(tmp_path / "scan.laz", "")
    (tmp_path / "scan.ply").write_bytes(b"ASTM-E57\1")  # whatever it is called
    with pytest.raises(BadParams, match=r"it is E57, .*`CloudCompare -SILENT -O scan\.ply -C_EXP"):
        find_clouds(tmp_path / "scan.ply", "")
    (tmp_path / "scan.ply").unlink()
    with pytest.raises(BadParams, match=r"no file ends in \.ply.*\nscan\.laz: it is LAZ"):
        find_clouds(tmp_path, "")


def test_a_single_file_may_be_named_otherwise(folder):
    assert find_clouds(folder / f"{GEAR}.ply", "") == {GEAR: folder / f"{GEAR}.ply"}
    assert find_clouds(folder / f"{GEAR}.ply", "other") == {"other": folder / f"{GEAR}.ply"}


def test_what_cannot_be_meant_is_refused(folder):
    (folder / "notes.doc").touch()
    with pytest.raises(BadParams, match="does not exist"):
        find_clouds(folder / "nowhere", "")
    with pytest.raises(BadParams, match="is a folder"):
        find_clouds(folder, GEAR)
    with pytest.raises(BadParams, match=r"no file ends in \.ply"):
        find_clouds(folder / "notes.doc", "")
    (folder / f"{GEAR}.npz").touch()
    with pytest.raises(BadParams, match="of one part"):
        find_clouds(folder, "")


def test_the_set_is_the_one_that_has_the_parts():
    assert (select_catalogue(PARTS, [GEAR]).path, select_catalogue(PARTS, [GEAR]).select) == (
        str(EMBEDDED_FOLDER),
        [GEAR],
    )
    assert select_catalogue(PARTS, [VASE]).path.endswith("data/organic")


def test_an_unknown_part_is_named():
    with pytest.raises(BadParams, match=r"no part is called 'gear-spur'.*--set embedded"):
        select_catalogue(PARTS, [GEAR, "gear-spur"])


def test_clouds_of_two_sets_are_said_to_be():
    with pytest.raises(BadParams, match="parts of several sets"):
        select_catalogue(PARTS, [GEAR, VASE])
    with pytest.raises(BadParams, match="no part is called 'gear-spur'"):
        select_catalogue(PARTS, [GEAR, VASE, "gear-spur"])


def test_a_cad_file_is_a_part_by_its_name(tmp_path):
    mesh = solids.box(1, 2, 3)
    trimesh.Trimesh(mesh.vertices, mesh.faces).export(tmp_path / "My Bracket.stl")
    selected, part_id = user_cad(PARTS, tmp_path / "My Bracket.stl")
    assert part_id == "my-bracket"
    assert (selected.source, selected.path) == ("path", str(tmp_path / "My Bracket.stl"))


def test_what_looks_like_a_path_is_a_file_that_exists(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.step").touch()
    (tmp_path / "b.stp").mkdir()
    assert cad_file("a.step") == Path("a.step")
    assert (cad_file(GEAR), cad_file("")) == (None, None)
    for name in ("nosuch.step", "nosuch.STL", "sub/nosuch"):
        with pytest.raises(BadParams, match=f"^{name} does not exist; give one CAD file"):
            cad_file(name)
    for name in ("b.stp", str(tmp_path)):
        with pytest.raises(BadParams, match=f"^{name} is a folder; give one CAD file"):
            cad_file(name)


def test_a_folder_by_its_bare_name_is_called_one(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("drawings", GEAR):
        (tmp_path / name).mkdir()
    assert cad_file(GEAR) is None  # the part of the suite
    with pytest.raises(BadParams, match=r"^drawings is a folder"):
        cad_file("drawings")


def test_a_misspelled_part_is_asked_about(tmp_path):
    with pytest.raises(BadParams, match=r"'gear-spur-m2-z42', did you mean `gear-spur-m2-z24`"):
        select_catalogue(PARTS, ["gear-spur-m2-z42"])
