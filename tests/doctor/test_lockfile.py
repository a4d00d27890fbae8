"""dvc.lock, cut short or foreign."""

from collections.abc import Callable

import pytest

from industnerf.doctor import lockfile
from industnerf.errors import BadArtifact
from tests.doctor.conftest import WorkingCopy

FAULTS = {
    "empty": lambda text: "",
    "ends within a word": lambda text: text[: text.index("stages") + 3],
    "ends before the first stage": lambda text: text[: text.index("make")],
    "ends within a stage's name": lambda text: text[: text.index("cmd") - 4] + "\n",
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


def test_dvc_is_not_started_on_a_spoilt_lock_file(dvc_copy: WorkingCopy):
    lock = dvc_copy.folder / "dvc.lock"
    original = lock.read_text()
    lockfile.require_intact(dvc_copy.paths, dvc_copy.folder)
    try:
        lock.write_text(FAULTS["a stage that is no more"](original))  # DVC passes it over
        lockfile.require_intact(dvc_copy.paths, dvc_copy.folder)
        lock.write_text("")
        with pytest.raises(BadArtifact, match=r"cut short(.|\n)*mends it: .* dvc.lock"):
            lockfile.require_intact(dvc_copy.paths, dvc_copy.folder)
        lockfile.require_intact(
            dvc_copy.paths, dvc_copy.folder / "runs" / "demo"
        )  # is another project
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
