"""Small files: whole or as they were before, whatever the text holds."""

import os
import subprocess
import sys

import pytest

from industnerf.artifacts import files
from industnerf.artifacts.files import atomic_write, check_writable, write_text
from industnerf.errors import BadArtifact


def test_text_is_utf8_whatever_the_locale(tmp_path):
    """Report and README say that they are, and go from one machine to another."""
    steps = r"""
from pathlib import Path
from industnerf.artifacts.files import read_json, write_json, write_text
write_json(Path("a.json"), {"schema": 1})
write_text(Path("a.json"), Path("a.json").read_text().replace("1", '1, "unit": "m\u00b2"'))
assert read_json(Path("a.json"), 1, "x")["unit"] == "m\u00b2"
"""
    ascii_alone = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    command = [sys.executable, "-c", steps]
    subprocess.run(command, cwd=tmp_path, check=True, env=os.environ | ascii_alone)
    assert "\u00b2".encode() in (tmp_path / "a.json").read_bytes()


def test_a_name_that_is_not_utf8_is_written_as_it_is(tmp_path):
    """A table of files holds their names, and a name is any bytes."""
    write_text(tmp_path / "check.csv", os.fsdecode(b"caf\xe9.stl,whole\n"))
    assert (tmp_path / "check.csv").read_bytes() == b"caf\xe9.stl,whole\n"


def test_a_text_that_cannot_be_written_leaves_no_trace(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(UnicodeEncodeError):
        write_text(path, "new \ud800")  # half a pair, which no file name decodes to
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_cannot_be_made_is_named(tmp_path):
    (tmp_path / "a.txt").write_text("no folder")
    with pytest.raises(BadArtifact, match=r"a\.txt/b\.txt: cannot be written: File exists"):
        write_text(tmp_path / "a.txt" / "b.txt", "")


def test_a_text_is_on_the_disk_before_it_has_its_name(tmp_path, monkeypatch):
    """Where the disk turns out to be full only then, what was there stays."""

    def full(descriptor):
        raise OSError(28, "No space left on device")

    path = tmp_path / "a.txt"
    path.write_text("old")
    monkeypatch.setattr(files.os, "fsync", full)
    with pytest.raises(BadArtifact, match=r"a.txt: cannot be written: No space left"):
        write_text(path, "new")
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_file_appears_when_it_is_whole(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with atomic_write(path) as draft:
        draft.write_text("new")
        assert path.read_text() == "old"
    assert path.read_text() == "new"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("kind", [RuntimeError, KeyboardInterrupt])
def test_a_torn_draft_leaves_no_trace(tmp_path, kind):
    path = tmp_path / "a.txt"
    path.write_text("old")

    def tear(draft):
        draft.write_text("ne")
        raise kind

    with pytest.raises(kind), atomic_write(path) as draft:
        tear(draft)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_full_disk_is_said(tmp_path):
    def write():
        with atomic_write(tmp_path / "a.txt"):
            raise OSError(28, "No space left on device")

    with pytest.raises(BadArtifact, match=r"a.txt: cannot be written: No space left"):
        write()


def test_folders_are_made_and_tried(tmp_path):
    check_writable(tmp_path / "new/deep/a.ply", "--out")
    assert list((tmp_path / "new/deep").iterdir()) == []
    (tmp_path / "file").touch()
    with pytest.raises(BadArtifact, match=r"--out .*a.ply: cannot be written"):
        check_writable(tmp_path / "file/a.ply", "--out")


def test_a_folder_is_no_file(tmp_path):
    (tmp_path / "runs").mkdir()
    with pytest.raises(BadArtifact, match=r"--checkpoint .*runs: is a folder"):
        check_writable(tmp_path / "runs", "--checkpoint")
    assert list(tmp_path.rglob("*")) == [tmp_path / "runs"]
