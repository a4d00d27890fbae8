"""Small projects that run the real pipeline through DVC."""

import os
import signal
import subprocess
import time
from pathlib import Path

import pytest
import yaml

from pipeline.preset import create_project

SMALL = (
    "experiment=smoke",
    "methods=[hull,mean_shape,oracle]",
    "views.resolution=32",
    "views.count=6",
    "views.held_out=1",
    "method.hull.points=2048",
    "method.mean_shape={grid_res: 8, points: 2048}",
    "method.oracle.points=2048",
    "evaluate.points=128",
    "evaluate.dense_samples=2048",
    "evaluate.max_points=2048",
)
# the only files that may differ between two runs
TIMING_FILES = {
    "cost.csv",
    "cost.md",
    "goals.csv",
    "goals.md",
    "origins.md",
    "pareto.csv",
    "pareto.png",
    "report.html",
    "table1.md",
}


class Project:
    """A DVC project of its own in `folder`, with a store of its own."""

    def __init__(self, root: Path, folder: Path, *overrides: str) -> None:
        self.folder = folder
        create_project(root, folder, [*SMALL, *overrides])
        self.environment = {
            **os.environ,
            "INDUSTNERF_STORE": str(folder / "store"),
            "INDUSTNERF_MLFLOW": "off",
            "INDUSTNERF_WORKERS": "1",
        }

    def start(self, *command: str) -> subprocess.Popen:
        """Start `command` as the leader of a process group of its own."""
        # A shell's background job ignores Ctrl-C, and so would all that it starts.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        return subprocess.Popen(
            command,
            cwd=self.folder,
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )

    def run(self, *command: str) -> tuple[int, str]:
        """Exit code and output of `command`, dvc repro by default."""
        process = self.start(*(command or ("dvc", "repro")))
        output, _ = process.communicate()
        return process.returncode, output

    def stop_at(self, stage: str, signal_number: signal.Signals) -> tuple[int, str]:
        """Start dvc repro, and signal the whole group once `stage` is at its first part."""
        process = self.start("dvc", "repro")
        deadline = time.monotonic() + 120
        before = set(self.folder.glob(f"store/{stage}/*"))
        while set(self.folder.glob(f"store/{stage}/*")) <= before:
            assert time.monotonic() < deadline, f"{stage} never began"
            assert process.poll() is None, process.communicate()[0]
            time.sleep(0.005)
        os.killpg(process.pid, signal_number)
        output, _ = process.communicate()
        return process.returncode, output

    def finished(self) -> dict[str, int]:
        """When each finished result was made: unchanged means not redone."""
        return {
            str(path.relative_to(self.folder)): path.stat().st_mtime_ns
            for path in self.folder.glob("store/*/*/cost.json")
            if ".draft" not in path.parent.name
        }

    def outputs(self) -> dict[str, bytes]:
        """Every output file but the timed ones."""
        files = [p for name in ("data", "reports") for p in (self.folder / name).rglob("*")]
        return {
            str(path.relative_to(self.folder)): path.read_bytes()
            for path in files
            if path.is_file()
            and path.name not in TIMING_FILES
            and not {"embedded", "metrics"} & set(path.parts)
        }

    def set(self, **changes: object) -> dict[str, object]:
        """Change top-level keys of params.yaml, or keys of a section given as a dict.

        Returns what stood there; a key that was not there comes back as None and is removed.
        """
        path = self.folder / "params.yaml"
        params = yaml.safe_load(path.read_text())
        before = {key: _set_key(params, key, value) for key, value in changes.items()}
        path.write_text(yaml.safe_dump(params))
        return before


def _set_key(section: dict, key: str, value: object) -> object:
    before = section.get(key)
    if isinstance(value, dict):
        return {name: _set_key(section[key], name, item) for name, item in value.items()}
    if value is None:
        del section[key]
    else:
        section[key] = value
    return before


@pytest.fixture(scope="session")
def finished_run(tmp_path_factory):
    """A project that ran to its end, undisturbed.  Tests must leave it as it is."""
    root = Path(__file__).parents[2]
    project = Project(root, tmp_path_factory.mktemp("finished") / "project")
    code, output = project.run()
    assert code == 0, output
    return project
