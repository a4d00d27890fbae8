"""A damaged file in DVC's cache: DVC calls it up to date, the doctor does not."""

import os
from pathlib import Path

from industnerf.doctor.cache import objects
from tests.doctor.conftest import WorkingCopy


def corrupt(path: Path, content: bytes) -> None:
    """Change the file itself, not its name nor its times, as a failing disk does."""
    before = path.stat()
    path.chmod(0o644)
    path.write_bytes(content)
    path.chmod(0o444)
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))


def test_a_cache_as_dvc_left_it_is_right(dvc_copy: WorkingCopy):
    (project,) = dvc_copy.paths.projects()
    assert len(list(objects(project))) == 3  # two files, and the list of the folder
    assert dvc_copy.check("cache") == []


def test_a_damaged_file_goes_from_everywhere_and_is_made_anew(dvc_copy: WorkingCopy):
    output = dvc_copy.folder / "data/out/a"
    corrupt(output, b"hellO\n")
    _, message = dvc_copy.run("dvc status")
    assert "up to date" in message
    (finding,) = dvc_copy.check("cache")
    assert "its 6 bytes have another MD5" in finding.message
    assert "linked to 2 other place(s)" in finding.message  # the output, and the store
    dvc_copy.fix("cache")
    assert output.read_text() == "hello\n"
    assert dvc_copy.run("dvc status")[1].strip() == "Data and pipelines are up to date."


def test_a_damaged_list_of_a_folder_is_found_and_mended(dvc_copy: WorkingCopy):
    (listing,) = dvc_copy.folder.glob(".dvc/cache/files/md5/*/*.dir")
    corrupt(listing, b"[]")
    dvc_copy.fix("cache")
    assert listing.read_bytes() != b"[]"


def test_the_run_of_a_preset_is_examined_too(dvc_copy: WorkingCopy, tmp_path: Path):
    """Its command is another: the preset's, from the root."""
    outer = WorkingCopy(tmp_path)
    (tmp_path / "runs").mkdir()
    (tmp_path / "runs/demo").symlink_to(dvc_copy.folder)
    output = dvc_copy.folder / "data/out/a"
    corrupt(output, b"hellO\n")
    (finding,) = outer.check("cache")
    assert finding.fix.endswith("&& python -m pipeline.preset demo")
    dvc_copy.fix("cache")
