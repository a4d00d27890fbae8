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


def test_a_lock_file_as_dvc_left_it_is_right(copy: WorkingCopy):
    assert copy.find("lockfile") == []


def test_without_a_lock_file_nothing_is_wrong(plain: WorkingCopy):
    assert plain.find("lockfile") == []


@pytest.mark.parametrize("spoil", FAULTS.values(), ids=FAULTS)
def test_a_spoilt_lock_file_is_found_and_mended(copy: WorkingCopy, spoil: Callable[[str], str]):
    lock = copy.folder / "dvc.lock"
    whole = lock.read_text()
    lock.write_text(spoil(whole))
    copy.mend("lockfile")
    assert lock.read_text() == whole


def test_what_git_has_is_put_back(copy: WorkingCopy):
    commit = "git -c user.name=a -c user.email=a@b commit -qm all"
    assert copy.run(f"git init -q && git add -f dvc.lock && {commit}")[0] == 0
    lock = copy.folder / "dvc.lock"
    whole = lock.read_text()
    lock.write_text(whole[:20])
    (finding,) = copy.find("lockfile")
    assert finding.mend == "git checkout HEAD -- dvc.lock"
    copy.mend("lockfile")
    assert lock.read_text() == whole


def test_dvc_is_not_started_on_a_spoilt_lock_file(copy: WorkingCopy):
    lock = copy.folder / "dvc.lock"
    whole = lock.read_text()
    lockfile.require_whole(copy.places, copy.folder)
    try:
        lock.write_text(FAULTS["a stage that is no more"](whole))  # DVC passes it over
        lockfile.require_whole(copy.places, copy.folder)
        lock.write_text("")
        with pytest.raises(BadArtifact, match=r"cut short(.|\n)*mends it: .* dvc.lock"):
            lockfile.require_whole(copy.places, copy.folder)
        lockfile.require_whole(copy.places, copy.folder / "runs" / "demo")  # is another project
    finally:
        lock.write_text(whole)


def test_a_dvc_yaml_that_git_could_not_merge_is_said(copy: WorkingCopy):
    pipeline = copy.folder / "dvc.yaml"
    whole = pipeline.read_text()
    try:
        pipeline.write_text(f"<<<<<<< ours\n{whole}=======\n>>>>>>> theirs\n")
        (finding,) = copy.find("lockfile")
        assert "lockfile cannot be checked" in finding.what
        assert "dvc.yaml is not to be read" in finding.what
    finally:
        pipeline.write_text(whole)
