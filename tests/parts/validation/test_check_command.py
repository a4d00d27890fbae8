"""`python -m industnerf.parts check`: a verdict on each file, whatever the others do."""

import csv
import gc
import io
import os
import signal
import weakref
from dataclasses import replace

import pytest
import trimesh
from PIL import Image
from rich.console import Console

from industnerf.config import load_params
from industnerf.errors import BadParams
from industnerf.parts.validation import check_command as checking
from industnerf.parts.validation import validate_file
from industnerf.parts.validation.check_command import check_cad_files, expand_folders
from tests.conftest import ROOT


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch):
    """Starting processes is the runner's to test."""
    monkeypatch.setenv("INDUSTNERF_RUNNER", "serial")


@pytest.fixture
def folder(tmp_path):
    """A box; a box without a face and another inside it; text; and a file of no known type."""
    box = trimesh.creation.box((30, 20, 10))
    box.export(tmp_path / "good.stl")
    box.update_faces([i > 0 for i in range(12)])
    trimesh.util.concatenate([box, trimesh.creation.icosphere(1, 2.0)]).export(
        tmp_path / "open.ply"
    )
    (tmp_path / "bad.stl").write_text("this is no mesh at all")
    (tmp_path / "readme.txt").write_text("nor is this")
    return tmp_path


def run(paths, out, *, views=None, **changes):
    """The exit code, what was printed, and the rows of check.csv by file name."""
    console, params = Console(file=io.StringIO(), width=140), load_params(ROOT / "params.yaml")
    params = replace(params, parts=replace(params.parts, **changes))
    params = replace(params, views=replace(params.views, **(views or {})))
    code = check_cad_files(paths, params, out, console)
    with (out / "check.csv").open() as file:
        rows = {os.path.basename(row["file"]): row for row in csv.DictReader(file)}
    return code, console.file.getvalue(), rows


def test_every_file_gets_its_verdict(folder):
    code, text, rows = run([folder], folder / "out")
    assert code == 2  # one is refused
    assert {name: row["verdict"] for name, row in rows.items()} == {
        "bad.stl": "refused",
        "good.stl": "usable",
        "open.ply": "usable with warnings",
    }
    assert rows["bad.stl"]["refused"].startswith("no STL")  # the name is said once
    assert rows["good.stl"]["size_mm"] == "30; 20; 10"
    assert rows["good.stl"]["unit"] == "mm, assumed"
    assert rows["open.ply"]["open_edges"] == "3"
    assert "open edges: 3" in rows["open.ply"]["residual_defects"]
    assert float(rows["good.stl"]["seconds"]) > 0
    assert float(rows["good.stl"]["peak_mb"]) > 0
    assert "1 refused, 1 usable, 1 usable with warnings" in text
    for line in ("bad.stl: refused: no STL", "good.stl: usable\n", "    defect: open edges: 3"):
        assert line in text


def test_the_sheet_has_a_tile_for_every_file(folder, monkeypatch):
    tiles = []
    monkeypatch.setattr(
        checking, "write_contact_sheet", lambda given, path, columns: tiles.extend(given)
    )
    run([folder], folder / "out")
    assert [(tile.caption.split("\n"), tile.image is None) for tile in tiles] == [
        (["bad.stl", "refused"], True),
        (["good.stl", "usable"], False),
        (["open.ply", "usable with warnings"], False),
    ]


def test_no_mesh_is_kept_until_the_sheet_is_drawn(folder, monkeypatch):
    """A folder of large files would fill the memory with them."""
    meshes, is_alive = [], []
    original = checking.used_appearances

    def watched(mesh, finishes):
        meshes.append(weakref.ref(mesh))
        used = original(mesh, finishes)
        meshes.append(weakref.ref(used[0]))
        return used

    def sheet(*_):
        gc.collect()
        is_alive.extend(mesh() is not None for mesh in meshes)

    monkeypatch.setattr(checking, "used_appearances", watched)
    monkeypatch.setattr(checking, "write_contact_sheet", sheet)
    run([folder], folder / "out")
    assert is_alive == [False] * 4  # of two files, as they were read and as they are shown


def test_sound_files_alone_succeed_and_the_sheet_can_be_seen(folder):
    code, _, rows = run([folder / "good.stl"], folder / "out")
    assert code == 0
    assert list(rows) == ["good.stl"]
    with Image.open(folder / "out" / "check.png") as image:
        assert image.getextrema() != ((255, 255),) * 3


def test_units_are_those_that_are_stated(folder):
    _, text, rows = run([folder / "good.stl"], folder / "out", units="inch")
    assert rows["good.stl"]["size_mm"] == "762; 508; 254"
    assert "binary STL (inch?), 762 x 508 x 254" in text
    assert "note:" not in text


def test_a_unit_that_makes_a_tiny_part_is_a_note_and_no_defect(tmp_path):
    trimesh.creation.box((0.3, 0.2, 0.1)).export(tmp_path / "meters.stl")
    trimesh.creation.box((0.003, 0.002, 0.001)).export(tmp_path / "stated.glb")
    code, text, rows = run([tmp_path], tmp_path / "out")
    assert code == 0
    note = "its largest side is 0.3 mm if its numbers are mm, as assumed; it is 300 if m, 7.62 if"
    assert f"meters.stl: usable\n    note: {note}" in text
    assert note in rows["meters.stl"]["notes"]
    assert rows["stated.glb"]["notes"] == ""
    assert "GLB (m), 3 x 1 x 2" in text


def test_area_volume_and_bodies_are_those_of_the_solid(folder):
    two = trimesh.creation.box((30, 20, 10)), trimesh.creation.box((5, 5, 5))
    two[1].apply_translation((40, 0, 0))
    trimesh.util.concatenate(two).export(folder / "two.stl")
    _, text, rows = run([folder], folder / "out")
    measured = {
        name: [rows[name][key] for key in ("area_mm2", "volume_mm3", "bodies")]
        for name in ("good.stl", "two.stl", "open.ply")
    }
    assert measured["good.stl"] == ["2200", "6000", "1"]
    assert measured["two.stl"] == ["2350", "6125", "2"]
    assert measured["open.ply"][1:] == ["", "2"]  # what is open holds no volume
    for words in (("area", "volume", "bodies"), ("2200", "6000"), ("2350", "6125"), ("open",)):
        assert any(all(word in line for word in words) for line in text.splitlines())


def test_what_is_no_cad_in_a_folder_is_named_but_for_sidecars(tmp_path):
    (tmp_path / "a.obj").write_text("mtllib a.mtl\nv 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\nf 3 2 1\n")
    (tmp_path / "a.mtl").write_text("newmtl red\nKd 1 0 0\n")
    for name in ("cloud.pcd", "notes.txt", ".hidden"):
        (tmp_path / name).write_text("x")
    _, text, _ = run([tmp_path], tmp_path / "out")
    assert "left out, for they are no CAD: cloud.pcd, notes.txt\n" in text


def test_a_light_part_before_white_is_warninged_upon(tmp_path):
    (tmp_path / "light.mtl").write_text("newmtl light\nKd 0.9 0.9 0.9\n")
    box = trimesh.creation.box((30, 20, 10))
    box.export(tmp_path / "plain.obj")
    text = (tmp_path / "plain.obj").read_text()
    (tmp_path / "light.obj").write_text(f"mtllib light.mtl\nusemtl light\n{text}")
    files = [tmp_path / "plain.obj", tmp_path / "light.obj"]
    _, _, rows = run(files, tmp_path / "out", views={"background": "white"})
    assert rows["plain.obj"]["notes"] == ""
    assert "within 0.02 of the background's color" in rows["light.obj"]["notes"]
    _, _, rows = run(files, tmp_path / "out")
    assert rows["light.obj"]["notes"] == ""


def test_a_stated_unit_can_be_overridden_and_an_absurd_one_is_warninged_upon(tmp_path):
    trimesh.creation.box((60, 40, 32)).export(tmp_path / "mm.glb")
    _, text, rows = run([tmp_path / "mm.glb"], tmp_path / "out")
    assert (
        "    note: its largest side is 6e+04 mm if its numbers are m, as stated; it is 60 if mm, "
        "600 if cm, 1524 if inch (parts.override_units, --override-units)\n"
    ) in text
    _, text, rows = run([tmp_path / "mm.glb"], tmp_path / "out", override_units=True)
    assert rows["mm.glb"]["size_mm"] == "60; 32; 40"
    assert rows["mm.glb"]["unit"] == "mm, overridden"
    assert rows["mm.glb"]["notes"] == ""


def test_solids_can_be_checked_one_by_one(tmp_path):
    dot = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    scene = trimesh.Scene({"plate": trimesh.creation.box((3, 2, 1)), "dot": dot})
    scene.export(tmp_path / "two.glb")
    _, text, _ = run([tmp_path / "two.glb"], tmp_path / "out", split_bodies=True)
    assert "two.glb: plate: usable\n" in text
    assert "two.glb: dot: refused: it has 1 sound face" in text
    _, text, rows = run([tmp_path / "two.glb"], tmp_path / "out")
    assert rows["two.glb"]["solids"] == "2"


def test_a_named_file_is_checked_under_any_type(folder):
    _, text, rows = run([folder / "readme.txt", folder / "nowhere.stl"], folder / "out")
    assert rows["readme.txt"]["verdict"] == rows["nowhere.stl"]["verdict"] == "refused"
    assert "nowhere.stl: refused: cannot be opened: No such file" in text


def test_a_folder_without_cad_is_named(tmp_path):
    (tmp_path / "readme.txt").touch()
    with pytest.raises(BadParams, match=r"check: no file in .* ends in \.step.*; it has readme"):
        expand_folders([tmp_path])


def test_a_folder_is_searched_for_files_and_not_for_hidden_ones_or_folders(folder):
    (folder / "deep.stl").mkdir()
    (folder / ".venv").mkdir()
    # macOS writes the first beside each file
    for name in ("._good.stl", ".venv/sample.stl", "deep.stl/more.STL"):
        (folder / name).write_bytes((folder / "good.stl").read_bytes())
    files, unread = expand_folders([folder])
    names = [str(path.relative_to(folder)) for path in files]
    assert [path.name for path in unread] == ["readme.txt"]
    assert names == ["bad.stl", "deep.stl/more.STL", "good.stl", "open.ply"]


def test_a_refusal_names_its_file_once(folder, capsys):
    run([folder / "bad.stl"], folder / "out")
    printed = "".join(capsys.readouterr().out.split())  # a narrow terminal breaks lines anywhere
    assert "bad.stlfailed:noSTL:neither" in printed


@pytest.mark.parametrize("out", ["good.stl", "good.stl/below"])
def test_a_place_that_cannot_be_written_is_refused_before_any_work(folder, monkeypatch, out):
    monkeypatch.setattr(checking, "_validate_all", lambda *_: pytest.fail("it worked"))
    with pytest.raises(BadParams, match=r"check: --out .*good.stl.*: cannot be written: .*"):
        run([folder], folder / out)


def test_a_full_or_locked_disk_is_noticed_before_any_work(folder, monkeypatch):
    def locked(dir):
        raise OSError(30, "Read-only file system")

    monkeypatch.setattr(checking.tempfile, "TemporaryFile", locked)
    with pytest.raises(BadParams, match="cannot be written: Read-only file system"):
        run([folder], folder / "out")


def test_solids_of_one_name_are_numbered_as_in_part_ids(tmp_path):
    box = trimesh.creation.box((3, 2, 1))
    scene = trimesh.Scene()
    for node in ("nut", "bolt", "Nut"):
        scene.add_geometry(box, node_name=node, geom_name=node)
    scene.export(tmp_path / "three.glb")
    _, text, _ = run([tmp_path / "three.glb"], tmp_path / "out", split_bodies=True)
    for name in ("nut-1", "bolt", "nut-3"):
        assert f"three.glb: {name}: usable\n" in text


def test_the_only_solid_of_a_file_is_the_file(folder):
    _, text, rows = run([folder / "good.stl"], folder / "out", split_bodies=True)
    assert rows["good.stl"]["solid"] == ""
    assert "good.stl: usable\n" in text


def test_ctrl_c_leaves_what_was_finished(folder, monkeypatch):
    original = validate_file.read_solids

    def read(path, *units):
        if path.name == "open.ply":
            raise KeyboardInterrupt
        return original(path, *units)

    monkeypatch.setattr(validate_file, "read_solids", read)
    code, _, rows = run([folder], folder / "out")
    assert code == 130
    assert sorted(rows) == ["bad.stl", "good.stl"]


def test_the_command_line(folder, monkeypatch, capsys):
    from industnerf.parts.__main__ import main

    monkeypatch.chdir(folder)  # no params.yaml here: the one that came with the code
    arguments = ["check", "good.stl", "--units", "cm", "--out", "out"]
    monkeypatch.setattr("sys.argv", ["industnerf.parts", *arguments])
    assert main() == 0
    assert "good.stl: usable\n" in capsys.readouterr().out
    assert "300; 200; 100" in (folder / "out" / "check.csv").read_text()


@pytest.mark.slow
def test_a_file_that_takes_too_long_or_too_much_costs_itself_only(folder, monkeypatch):
    """In processes: one file hangs, and the other is done."""
    monkeypatch.setenv("INDUSTNERF_RUNNER", "process")
    os.mkfifo(folder / "hangs.stl")  # to open it waits for a writer that never comes
    before = signal.getsignal(signal.SIGINT)
    _, _, rows = run([folder / "hangs.stl", folder / "good.stl"], folder / "out", time_limit_s=20.0)
    assert rows["good.stl"]["verdict"] == "usable"
    assert "20" in rows["hangs.stl"]["refused"]
    assert signal.getsignal(signal.SIGINT) == before
