"""A disk that is full in the middle of every stage."""

import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from industnerf.doctor.lockfile import replace_torn
from tests.campaign.conftest import small_tmpfs
from tests.pipeline.conftest import Project

pytestmark = pytest.mark.campaign
STAGES = ("parts", "views", "split", "truth", "train", "reconstruct", "evaluate", "report")
AMPLE = 2**30  # bytes


def used_bytes(folder: Path) -> int:
    status = os.statvfs(folder)
    return (status.f_blocks - status.f_bfree) * status.f_frsize


def resize(folder: Path, size: int) -> None:
    subprocess.run(["mount", "-o", f"remount,size={size}", str(folder)], check=True)


def test_a_full_disk_costs_nothing(root: Path, tmp_path: Path, print_row: Callable[[str], None]):
    growth = {}
    with small_tmpfs(tmp_path / "ample", str(AMPLE)):
        ample = Project(root, tmp_path / "ample/project")
        assert ample.run("dvc", "repro", "-s", "solids")[0] == 0  # of the catalogue it has none
        for stage in STAGES:
            before = used_bytes(tmp_path / "ample")
            code, output = ample.run("dvc", "repro", "-s", stage)
            assert code == 0, output
            growth[stage] = used_bytes(tmp_path / "ample") - before
        expected = ample.outputs()
    with small_tmpfs(tmp_path / "small", str(AMPLE)):
        project = Project(root, tmp_path / "small/project")
        assert project.run("dvc", "repro", "-s", "solids")[0] == 0
        for stage in STAGES:
            for divisor in (8, 2):  # it fills in the stage itself, and where DVC copies
                room = growth[stage] // divisor
                resize(tmp_path / "small", used_bytes(tmp_path / "small") + room)
                code, output = project.run("dvc", "repro", "-s", stage)
                resize(tmp_path / "small", AMPLE)
                words = ("No space", "ERROR", "error")  # DVC's database has its own for it
                reason = next(
                    (line for word in words for line in output.splitlines() if word in line), ""
                )
                print_row(
                    f"disk full, {stage}, {room / 1e3:.0f} kB left: exit {code}, {reason[:80]}"
                )
                # DVC ends with 0 where the outputs are whole and only its cache has no room
                assert code != 0 or reason.startswith("ERROR: failed to transfer"), output
                replace_torn(project.folder)
            code, output = project.run("dvc", "repro", "-s", stage)
            assert code == 0, output
        outputs = project.outputs()
        assert [name for name in expected if outputs.get(name) != expected[name]] == []
        print_row(f"disk full: {len(expected)} files as on an ample disk")
