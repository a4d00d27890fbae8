"""dvc.lock, cut short or foreign."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from industnerf.doctor import lockfile
from tests.doctor.conftest import WorkingCopy

FAULTS = {
    "empty": lambda text: "",
    "ends within a word": lambda text: text[: text.index("stages") + 3],
    "ends before the first stage": lambda text: text[: text.index("make")],
    "ends within a stage's name": lambda text: text[: text.index("cmd") - 4] + "\n",
    "ends within an entry": lambda text: text[: text.rindex("md5:") + 6],
    "two versions in conflict": lambda text: f"<<<<<<< ours\n{text}=======\n{text}>>>>>>> theirs\n",
    "a stage that is no more": lambda text: text + "  gone@hull:\n    cmd: 'true'\n",
}


def test_a_lock_file_as_dvc_left_it_is_right(dvc_copy: WorkingCopy):
    assert dvc_copy.check("lockfile") == []


def test_without_a_lock_file_nothing_is_wrong(bare_copy: WorkingCopy):
    assert bare_copy.check("lockfile") == []


@pytest.mark.parametrize("corrupt", FAULTS.values(), ids=FAULTS)
def test_a_spoilt_lock_file_is_found_and_mended(
    dvc_copy: WorkingCopy, corrupt: Callable[[str], str]
):
    lock = dvc_copy.folder / "dvc.lock"
    original = lock.read_text()
    lock.write_text(corrupt(original))
    dvc_copy.fix("lockfile")
    assert lock.read_text() == original


def test_what_git_has_is_put_back(dvc_copy: WorkingCopy):
    commit = "git -c user.name=a -c user.email=a@b commit -qm all"
    assert dvc_copy.run(f"git init -q && git add -f dvc.lock && {commit}")[0] == 0
    lock = dvc_copy.folder / "dvc.lock"
    original = lock.read_text()
    lock.write_text(original[:20])
    (finding,) = dvc_copy.check("lockfile")
    assert finding.fix == "git checkout HEAD -- dvc.lock"
    dvc_copy.fix("lockfile")
    assert lock.read_text() == original


@pytest.mark.parametrize(
    "damage", ["empty", "ends within a word", "ends within an entry", "two versions in conflict"]
)
def test_a_torn_lock_file_is_set_aside_and_the_run_goes_on(
    dvc_copy: WorkingCopy, damage: str, capsys: pytest.CaptureFixture[str]
):
    lock = dvc_copy.folder / "dvc.lock"
    original = lock.read_text()
    torn = FAULTS[damage](original)
    lock.write_text(torn)
    lockfile.replace_torn(dvc_copy.folder)
    said = capsys.readouterr().err
    aside = max(dvc_copy.folder.glob(".dvc/tmp/dvc.lock.torn-*"))
    assert f"It is set aside, {aside}, and " in said
    assert aside.read_text() == torn
    assert dvc_copy.run("dvc repro -q") == (0, "")
    assert lock.read_text() == original


def test_of_a_torn_lock_file_the_committed_one_is_put_back(
    dvc_copy: WorkingCopy, capsys: pytest.CaptureFixture[str], tmp_path: Path
):
    project = tmp_path / "project"
    shutil.copytree(dvc_copy.folder, project, ignore=shutil.ignore_patterns(".git"))
    commit = "git -c user.name=a -c user.email=a@b commit -qm all"
    assert WorkingCopy(project).run(f"git init -q && git add -f dvc.lock && {commit}")[0] == 0
    lock = project / "dvc.lock"
    original = lock.read_text()
    lock.write_text("")
    lockfile.replace_torn(project)
    assert lock.read_text() == original
    assert "the last committed one is put back" in capsys.readouterr().err


def test_a_whole_lock_file_stays(dvc_copy: WorkingCopy):
    """Also where it has a stage that is no more, which DVC passes over."""
    lock = dvc_copy.folder / "dvc.lock"
    original = lock.read_text()
    foreign = FAULTS["a stage that is no more"](original)
    try:
        lock.write_text(foreign)
        lockfile.replace_torn(dvc_copy.folder)
        assert lock.read_text() == foreign
        lockfile.replace_torn(dvc_copy.folder / "runs" / "demo")  # has none
    finally:
        lock.write_text(original)


def test_a_dvc_yaml_that_git_could_not_merge_is_said(dvc_copy: WorkingCopy):
    pipeline = dvc_copy.folder / "dvc.yaml"
    original = pipeline.read_text()
    try:
        pipeline.write_text(f"<<<<<<< ours\n{original}=======\n>>>>>>> theirs\n")
        (finding,) = dvc_copy.check("lockfile")
        assert "lockfile cannot be checked" in finding.message
        assert "dvc.yaml is not to be read" in finding.message
    finally:
        pipeline.write_text(original)
