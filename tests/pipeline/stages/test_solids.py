"""The stage that reads: nothing for the catalogue; own files once, and again when they change."""

from types import SimpleNamespace

import pytest

from industnerf.artifacts.solids import Solids
from industnerf.errors import PartsFailed
from industnerf.stage import read_failures, read_index
from pipeline.stages.solids import main

TRIANGLE = b"mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl paint\nf 1 2 3\n"


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_STORE", str(tmp_path / "store"))
    monkeypatch.setenv("INDUSTNERF_RUNNER", "serial")
    (tmp_path / "cad").mkdir()

    def run(source="path", on_failure="report", **changes):
        values = {"pattern": "**/*", "units": "mm", "select": [], "source": source}
        values |= {"override_units": False, "time_limit_s": 60.0, "memory_limit_mb": 4096}
        cfg = SimpleNamespace(parts=SimpleNamespace(**(values | changes)), on_failure=on_failure)
        main(cfg, str(tmp_path / "cad"), str(tmp_path / "out"))
        return read_index(tmp_path / "out")

    return run


def test_for_the_catalogue_it_does_nothing_and_says_so_in_an_empty_index(run, tmp_path):
    assert run(source="embedded", on_failure="strict") == {}
    assert read_failures(tmp_path / "out") == {}


def test_a_file_is_read_once_and_again_when_it_or_its_material_changes(run, tmp_path):
    (tmp_path / "cad" / "t.obj").write_bytes(TRIANGLE)
    (tmp_path / "cad" / "t.mtl").write_text("newmtl paint\nKd 1 0 0\n")
    first = run()
    assert run() == first
    (tmp_path / "cad" / "other.mtl").touch()
    assert run() == first  # nobody names it
    (tmp_path / "cad" / "t.mtl").write_text("newmtl paint\nKd 0 1 0\n")
    assert run() != first
    assert [f.name for f in Solids.load(tmp_path / "out" / "t").finishes] == ["#00ff00"]
    assert run(units="cm") != first


def test_what_is_no_cad_is_named_and_a_unit_can_be_overridden(run, tmp_path, capsys):
    (tmp_path / "cad" / "t.obj").write_bytes(TRIANGLE)
    (tmp_path / "cad" / "t.mtl").write_text("newmtl paint\nKd 1 0 0\n")
    (tmp_path / "cad" / "scan.pcd").touch()
    first = run()
    assert "solids: left out, for they are no CAD: scan.pcd\n" in capsys.readouterr().out
    assert run(override_units=True) != first


def test_files_that_fail_are_listed_and_only_selected_ones_are_read(run, tmp_path):
    (tmp_path / "cad" / "a.obj").write_bytes(TRIANGLE)
    (tmp_path / "cad" / "b.stl").write_bytes(b"words")
    assert list(run()) == ["a"]
    assert list(read_failures(tmp_path / "out")) == ["b"]
    assert list(run(select=["a"], on_failure="strict")) == ["a"]
    with pytest.raises(PartsFailed, match=r"(?s)1 of 2 parts failed.*b\.stl: no STL"):
        run(on_failure="strict")
