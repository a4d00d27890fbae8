"""A file is there whole, or as it was before."""

import pytest

from industnerf.artifacts.atomic_write import atomic_write, check_writable
from industnerf.errors import BadArtifact


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
