"""The command line over a method that is a stand-in."""

import sys
from dataclasses import dataclass
from pathlib import Path

import pytest
import torch

from industnerf.reconstruct import __main__ as command
from industnerf.reconstruct import origin, settings
from tests.reconstruct import fake_run, scene

METHOD = "industnerf.methods.industnerf.run"
OURS = ("industnerf.reconstruct.work", "industnerf.reconstruct.watching")
PARAMS = """\
seed: 3
method:
  industnerf: {steps: 6, rate: 1.0e-3, reading: intended}
  industnerf_plus: {steps: 2, rate: 1.0e-3, reading: intended}
"""


@dataclass(frozen=True)
class FakeSettings:
    steps: int
    rate: float
    reading: str


@dataclass(frozen=True)
class FakeMethods:
    industnerf: FakeSettings
    industnerf_plus: FakeSettings


@dataclass(frozen=True)
class FakeParams:
    seed: int
    method: FakeMethods


@pytest.fixture
def fake(monkeypatch):
    """The stand-in, for as long as the test runs; our modules that import it go with it."""
    torch.set_num_threads(1)
    monkeypatch.setitem(sys.modules, METHOD, fake_run)
    monkeypatch.setattr(settings, "Params", FakeParams)
    monkeypatch.setattr(origin, "code_digest", lambda module: "code")
    fake_run.AT.clear()
    fake_run.SEEN.clear()
    for name in OURS:
        sys.modules.pop(name, None)
    yield fake_run
    for name in OURS:
        sys.modules.pop(name, None)


class Desk:
    """A folder with photographs and params.yaml, and the command in it."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
        self.folder, self._monkeypatch, self._capsys = folder, monkeypatch, capsys
        self.transforms = scene.write(folder / "set")
        (folder / "params.yaml").write_text(PARAMS)
        self.out = folder / "cloud.ply"
        self.checkpoint = folder / "cloud.ply.checkpoint"

    def run(self, *arguments: object) -> tuple[int, str, str]:
        """Exit code, output and errors of the command with `arguments` and the usual ones."""
        usual = ("--cameras", self.transforms, "--params", self.folder / "params.yaml")
        line = [*usual, *(() if "--out" in arguments else ("--out", self.out)), *arguments]
        self._monkeypatch.setattr(sys, "argv", ["reconstruct", *map(str, line)])
        try:
            code = command.main()
        except SystemExit as end:  # argparse
            code = end.code
        return code, *self._capsys.readouterr()

    def files(self) -> set[str]:
        """What lies in the folder, hidden files included."""
        return {path.name for path in self.folder.iterdir()}


@pytest.fixture
def desk(tmp_path, monkeypatch, capsys, fake) -> Desk:
    return Desk(tmp_path, monkeypatch, capsys)
