"""The command: what it prints, how it ends, and what it does not import."""

import re
from pathlib import Path

import pytest

from industnerf.doctor import CHECKS, run_check
from industnerf.doctor.project_paths import ProjectPaths
from industnerf.errors import BadParams
from industnerf.tracking import database_dir
from tests.doctor.conftest import WorkingCopy, doctor

HEAVY = """
import runpy, sys
sys.argv = ["doctor", "cache", "lockfile", "locks", "stale_files", "store", "database"]
try:
    runpy.run_module("industnerf.doctor", run_name="__main__")
finally:
    print("heavy:", sorted({"torch", "mlflow", "warp", "dvc", "numpy"} & set(sys.modules)))
"""


def test_what_is_right_ends_with_0_and_without_heavy_imports(bare_copy: WorkingCopy):
    code, output = doctor(bare_copy.folder, "-c", HEAVY)
    assert code == 0, output
    assert "nothing is wrong" in output
    assert "heavy: []" in output


def test_what_is_wrong_is_said_with_its_mending_and_ends_with_1(bare_copy: WorkingCopy):
    entry = f"store/views/{32 * 'a'}"
    (bare_copy.folder / entry).mkdir(parents=True)
    (bare_copy.folder / entry / "manifest.json").write_text("{")
    code, output = doctor(bare_copy.folder, "-m", "industnerf.doctor", "locks", "store")
    assert code == 1
    assert re.sub(r"-\d{18,}", "-TIME", output) == (
        "locks        ok\n"
        "store        wrong\n"
        f"  {entry}: manifest.json is torn\n"
        f"    mend: mv {entry} store/views/.damaged-{32 * 'a'}-TIME\n"
        "1 thing is wrong\n"
    )
    assert (bare_copy.folder / entry).exists()  # it never mends by itself


def test_without_a_name_every_check_is_made(bare_copy: WorkingCopy):
    _, output = doctor(bare_copy.folder, INDUSTNERF_DEVICE="gpu")
    verdicts = [line.split() for line in output.splitlines()]
    assert [two[0] for two in verdicts if two[1:] in (["ok"], ["wrong"])] == list(CHECKS)
    assert "INDUSTNERF_DEVICE is 'gpu'" in output


def test_an_unknown_check_is_refused_with_the_known_ones(bare_copy: WorkingCopy):
    code, output = doctor(bare_copy.folder, "-m", "industnerf.doctor", "cahce")
    assert code == 2
    assert "check 'cahce' is unknown, known are cache, lockfile" in output
    with pytest.raises(BadParams):
        run_check("findings", bare_copy.paths)  # a module of the package, but no check


def test_every_check_says_what_it_asks():
    code, output = doctor(".", "-m", "industnerf.doctor", "--help")
    assert code == 0
    assert all(description in output for description in CHECKS.values())


def test_the_database_is_where_tracking_has_it(
    bare_copy: WorkingCopy, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("INDUSTNERF_MLFLOW", "elsewhere")
    assert (
        type(bare_copy.paths).from_root(bare_copy.folder).database == database_dir() / "mlflow.db"
    )


def test_outside_the_root_a_check_says_what_it_lacks(tmp_path: Path):
    (finding,) = run_check("environment", ProjectPaths(tmp_path, tmp_path, tmp_path))
    assert "environment cannot be checked" in finding.message
    assert "constraints.txt" in finding.message
