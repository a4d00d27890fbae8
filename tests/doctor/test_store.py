"""Results in the store that something damaged."""

import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from industnerf.store import Cost, Store
from tests.doctor.conftest import WorkingCopy

KEY = 32 * "a"


def write_result(out: Path) -> Cost:
    (out / "rgb").mkdir()
    Image.fromarray(np.zeros((40, 40, 3), np.uint8)).save(out / "rgb" / "000.png")
    np.savez_compressed(out / "cloud.npz", points=np.zeros((9, 3)))
    (out / "cameras.json").write_text("{}")
    return Cost(2.0, 70.0, "cpu")


@pytest.fixture
def entry(bare_copy: WorkingCopy) -> Path:
    """A result as the store makes it."""
    Store(bare_copy.paths.store).put("views", KEY, write_result)
    return bare_copy.paths.store / "views" / KEY


def rewrite(path: Path, text: str) -> None:
    path.chmod(0o644)
    path.write_text(text)
    path.chmod(0o444)


def halve(path: Path) -> None:
    path.chmod(0o644)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    path.chmod(0o444)


def swap_bytes(path: Path) -> None:
    """Another content of the same size and time, as a failing disk has it."""
    status, content = path.stat(), path.read_bytes()
    path.chmod(0o644)
    path.write_bytes(content[::-1])
    os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))
    path.chmod(0o444)


CORRUPTIONS = {
    "out": (lambda entry: shutil.rmtree(entry / "out"), "3 of 5 files are missing"),
    "a file": (lambda entry: (entry / "out/cloud.npz").unlink(), "such as out/cloud.npz"),
    "half a picture": (lambda entry: halve(entry / "out/rgb/000.png"), "such as out/rgb/000.png"),
    "a bit": (lambda entry: swap_bytes(entry / "out/cloud.npz"), "1 of 5 files have another"),
    "a stranger": (lambda entry: (entry / "out/a").touch(), "1 files do not belong to it"),
    "no cost": (lambda entry: (entry / "cost.json").unlink(), "such as cost.json"),
    "half a cost": (lambda entry: rewrite(entry / "cost.json", '{"sec'), "have another content"),
    "half a manifest": (lambda entry: halve(entry / "manifest.json"), "manifest.json is torn"),
}


def test_a_result_as_the_store_makes_it_is_right(bare_copy: WorkingCopy, entry: Path):
    assert bare_copy.check("store") == []


@pytest.mark.parametrize(("corrupt", "message"), CORRUPTIONS.values(), ids=CORRUPTIONS)
def test_a_damaged_result_is_set_aside_and_can_be_made_anew(
    bare_copy: WorkingCopy, entry: Path, corrupt: Callable[[Path], None], message: str
):
    corrupt(entry)
    (finding,) = bare_copy.check("store")
    assert message in finding.message
    bare_copy.fix("store")
    store = Store(bare_copy.paths.store)
    store.put("views", KEY, write_result)
    assert store.cost("views", KEY) == Cost(2.0, 70.0, "cpu")


def test_the_stage_that_took_a_torn_result_is_named(dvc_copy: WorkingCopy):
    """DVC's own outputs are whole: without force it would have nothing to do."""
    Store(dvc_copy.paths.store).put("views", KEY, write_result)
    entry = dvc_copy.paths.store / "views" / KEY
    index = dvc_copy.folder / "data" / "clouds" / "hull" / "index.json"
    index.parent.mkdir(parents=True)
    index.write_text(json.dumps({"schema": 1, "step": "views", "keys": {"part": KEY}}))
    (entry / "cost.json").unlink()
    (finding,) = dvc_copy.check("store")
    store = dvc_copy.paths.store
    rerun = f"`(cd . && INDUSTNERF_STORE={store} dvc repro -f -s reconstruct)` makes it anew"
    assert finding.message.endswith(f"; once it is gone, {rerun}")
    assert finding.fix.startswith(f"mv {dvc_copy.paths.shell_words(entry)} store/views/.damaged-")


def test_what_no_run_uses_is_worth_knowing_only(bare_copy: WorkingCopy, entry: Path):
    entry.rename(entry.with_name(f".damaged-{KEY}-1"))
    (entry / "out").mkdir(parents=True)
    older, damaged = bare_copy.check("store")
    assert older.message.startswith("1 results have no manifest.json")
    assert damaged.message.startswith("1 results were found damaged and set aside")
    assert not older.is_error
    assert not damaged.is_error


def test_what_is_not_the_stores_is_left_alone(bare_copy: WorkingCopy):
    """A store may be named that is none: no advice may cost its owner anything."""
    (bare_copy.paths.store / "src" / "industnerf").mkdir(parents=True)
    assert bare_copy.check("store") == []


def test_a_file_that_can_be_written_to_is_found_and_closed(bare_copy: WorkingCopy, entry: Path):
    image_path = entry / "out/rgb/000.png"
    before = image_path.read_bytes()
    image_path.chmod(0o644)
    (finding,) = bare_copy.check("store")
    assert finding.message == "1 of 3 files can be written to, such as 000.png (-rw-r--r--)"
    bare_copy.fix("store")
    assert image_path.read_bytes() == before
    folders = entry / "out", entry / "out/rgb"
    assert all(path.stat().st_mode & 0o200 for path in folders)  # or it could not be removed
