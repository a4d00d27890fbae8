"""Working copies to be spoilt: real DVC projects, small enough to run in seconds."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from industnerf.doctor import run_check
from industnerf.doctor.findings import Finding
from industnerf.doctor.project_paths import ProjectPaths

# Its output is linked from the store and, by DVC, to the cache: one file in three places.
PIPELINE = """
stages:
  make:
    cmd: >-
      touch at-work; sleep $(cat pause);
      mkdir -p store/make/k/out data/out;
      test -e store/make/k/out/a || cp source store/make/k/out/a;
      ln -f store/make/k/out/a data/out/a;
      echo '{}' > data/out/index.json
    deps: [source]
    outs: [data/out]
"""


class WorkingCopy:
    """A folder with a DVC project, a store and no database, and what the doctor says of it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.paths = ProjectPaths(folder, folder / "store", folder / "mlflow.db")

    def check(self, name: str) -> list[Finding]:
        return run_check(name, self.paths)

    def start(self, command: str) -> subprocess.Popen:
        """Start `command` as the leader of a process group of its own."""
        environment = {**os.environ, "INDUSTNERF_MLFLOW": str(self.folder)}
        return subprocess.Popen(
            ["bash", "-c", command],
            cwd=self.folder,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )

    def run(self, command: str) -> tuple[int, str]:
        """Exit code and output of `command`."""
        process = self.start(command)
        output, _ = process.communicate()
        return process.returncode, output

    def fix(self, name: str) -> None:
        """Do what the doctor says about `check`; then nothing must be wrong with it."""
        (command,) = [finding.fix for finding in self.check(name) if finding.fix]
        code, output = self.run(command)
        assert code == 0, output
        assert not [finding for finding in self.check(name) if finding.is_error]


def doctor(folder: Path, *arguments: str, **variables: str) -> tuple[int, str]:
    """Exit code and output of Python in `folder` with `arguments`, or `-m industnerf.doctor`."""
    process = subprocess.run(
        [sys.executable, *(arguments or ("-m", "industnerf.doctor"))],
        cwd=folder,
        env={**os.environ, "INDUSTNERF_STORE": "store", **variables},
        check=False,
        capture_output=True,
        text=True,
    )
    return process.returncode, process.stdout + process.stderr


@pytest.fixture
def bare_copy(tmp_path: Path) -> WorkingCopy:
    """A working copy without a DVC project."""
    return WorkingCopy(tmp_path)


@pytest.fixture(scope="module")
def dvc_copy(tmp_path_factory: pytest.TempPathFactory) -> WorkingCopy:
    """A DVC project that has run.  A test that spoils it mends it."""
    working_copy = WorkingCopy(tmp_path_factory.mktemp("copy"))
    (working_copy.folder / "dvc.yaml").write_text(PIPELINE)
    (working_copy.folder / "source").write_text("hello\n")
    (working_copy.folder / "pause").write_text("0")
    setting = "dvc config cache.type hardlink,copy && dvc config core.analytics false"
    code, output = working_copy.run(f"dvc init --no-scm -q && {setting} && dvc repro")
    assert code == 0, output
    return working_copy
