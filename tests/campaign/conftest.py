"""Working copies that are ill-treated, and what they must come to all the same.

    python -m pytest -m campaign tests/campaign -s      an hour; disks need root

`-s` shows the lines of which the table in docs/reliability.md is made.
"""

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.pipeline.conftest import TIMING_FILES

SHARED = (
    *("src", "pipeline", "conf", "data", "results", "params.yaml", "dvc.yaml", "constraints.txt"),
    *(".dvcignore", "pyproject.toml"),
)
DOCTOR_CHECKS = ("cache", "lockfile", "locks", "stale_files", "store", "database")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Only whoever asks for the campaign gets it: neither `make test` nor `make test-all` does."""
    if "campaign" in config.option.markexpr:
        return
    asked = [item for item in items if item.get_closest_marker("campaign") is None]
    config.hook.pytest_deselected(items=[item for item in items if item not in asked])
    items[:] = asked


class WorkingCopy:
    """A root with the suite's code, a store and an MLflow database of its own."""

    def __init__(self, root: Path, folder: Path, preset: str) -> None:
        self.folder, self.preset = folder, preset
        folder.mkdir(parents=True)
        for name in SHARED:
            (folder / name).symlink_to(root / name)
        self.environment = {
            **os.environ,
            "INDUSTNERF_STORE": str(folder / "store"),
            "INDUSTNERF_MLFLOW": str(folder / "mlflow"),
        }

    @property
    def project(self) -> Path:
        return self.folder / "runs" / self.preset

    def start(self) -> subprocess.Popen:
        """The command of the preset, as the leader of a process group of its own."""
        with (self.folder / "log").open("a") as log:
            return subprocess.Popen(
                [sys.executable, "-m", "pipeline.preset", self.preset],
                cwd=self.folder,
                env=self.environment,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )

    def kill_after(self, seconds: float) -> int | None:
        """Start, and SIGKILL every process of it; the exit code if it ended before."""
        process = self.start()
        try:
            return process.wait(seconds)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            return None

    def log(self) -> str:
        return (self.folder / "log").read_text(errors="replace")

    def outputs(self) -> dict[str, bytes]:
        """Every output file but the timed ones."""
        files = [path for name in ("data", "reports") for path in (self.project / name).rglob("*")]
        return {
            str(path.relative_to(self.project)): path.read_bytes()
            for path in files
            if path.is_file() and path.name not in TIMING_FILES and "embedded" not in path.parts
        }

    def doctor(self) -> tuple[int, str]:
        """Exit code and output of the doctor, without the check of what is installed."""
        process = subprocess.run(
            [sys.executable, "-m", "industnerf.doctor", *DOCTOR_CHECKS],
            cwd=self.folder,
            env=self.environment,
            capture_output=True,
            text=True,
        )
        return process.returncode, process.stdout + process.stderr


@pytest.fixture
def print_row(capsys: pytest.CaptureFixture[str]) -> Callable[[str], None]:
    """Prints a row of the table at once."""

    def print_text(text: str) -> None:
        with capsys.disabled():
            print(f"campaign: {text}", flush=True)

    return print_text


@contextmanager
def small_tmpfs(folder: Path, size: str) -> Iterator[None]:
    """A disk of `size` at `folder`; the test is skipped where that needs a root who is not here."""
    folder.mkdir(parents=True, exist_ok=True)
    mount = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(folder)]
    if os.geteuid() or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("a disk of a given size needs root")
    try:
        yield
    finally:
        subprocess.run(["umount", "-l", str(folder)], check=True)
