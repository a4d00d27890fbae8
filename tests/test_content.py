"""Digests of inputs: of what lies there, or as the stage before has recorded them."""

import json
from functools import partial

import pytest

from industnerf.artifacts.archive import write_archive
from industnerf.content import RecordedDigests, content_digest, digest
from industnerf.stage import Task, read_index, run_stage


def write_pictures(target, *, mask="m"):
    """An archive, a file, and a folder in a folder."""
    with write_archive(target / "pictures.zip") as add:
        for name, text in (("cameras.json", "{}"), ("rgb/0.png", "a"), ("mask/0.png", mask)):
            add(name, text.encode())
    (target / "note").write_text("note")
    (target / "deep/er").mkdir(parents=True)
    (target / "deep/er/x").write_text("x")


def write_copy(source, target):
    (target / "copy").write_text(str(source))


INPUTS = ("", "note", "deep", "pictures.zip", "pictures.zip/rgb", "pictures.zip/cameras.json")


@pytest.fixture
def workdir(tmp_path, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_STORE", str(tmp_path / "store"))
    monkeypatch.setenv("INDUSTNERF_RUNNER", "serial")
    return tmp_path


def make_pictures(folder, mask="m"):
    tasks = [Task(name, partial(write_pictures, mask=mask), mask, ()) for name in ("p", "q")]
    run_stage("pictures", tasks, folder, "strict")
    return folder


@pytest.mark.parametrize("name", INPUTS)
def test_what_a_stage_has_recorded_is_what_its_files_are(workdir, name):
    out = make_pictures(workdir / "out")
    path = out / "p" / name
    recorded = RecordedDigests()
    assert recorded.find(path) == digest(path)
    assert content_digest([path], recorded) == content_digest([path])


@pytest.mark.parametrize("name", INPUTS)
def test_what_a_stage_has_recorded_is_not_read_again(workdir, name):
    out = make_pictures(workdir / "out")
    path = out / "p" / name
    expected = content_digest([path])
    for file in sorted((out / "p").rglob("*")):
        if file.is_file():
            file.unlink()
    assert content_digest([path], RecordedDigests()) == expected


def test_what_no_stage_has_recorded_is_read(workdir):
    (workdir / "own").write_text("own")
    for record in (None, "torn", "[]", json.dumps({"schema": 1, "keys": {}})):
        if record is not None:
            (workdir / "index.json").write_text(record)
        assert RecordedDigests().find(workdir / "own") is None
        assert content_digest([workdir / "own"], RecordedDigests()) == content_digest(
            [workdir / "own"]
        )


def test_a_member_that_is_not_declared_changes_no_key(workdir):
    """A method that asks for colors is not made anew because masks are other ones."""
    keys = {}
    for mask in ("m", "n"):
        out = make_pictures(workdir / mask, mask)
        for name in ("rgb", "mask"):
            inputs = (out / "p" / "pictures.zip" / name,)
            run_stage(
                "s", [Task("p", partial(write_copy, name), 0, inputs)], workdir / "s", "strict"
            )
            keys[mask, name] = read_index(workdir / "s")["p"]
    assert keys["m", "rgb"] == keys["n", "rgb"]
    assert keys["m", "mask"] != keys["n", "mask"]


def test_what_does_not_exist_has_no_digest(tmp_path):
    with pytest.raises(FileNotFoundError):
        content_digest([tmp_path / "absent"])
