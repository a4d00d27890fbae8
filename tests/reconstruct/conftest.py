"""The command line over a method that is a stand-in."""

import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from industnerf.reconstruct import __main__ as command
from industnerf.reconstruct import checkpoint, settings
from industnerf.torch_kernels import use_reproducible_kernels
from tests.reconstruct import fake_pipeline, sample_images

METHOD_MODULES = (
    "industnerf.methods.industnerf.pipeline",
    "industnerf.methods.industnerf_plus.pipeline",
)
RELOADED_MODULES = ("industnerf.reconstruct.run",)
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
    use_reproducible_kernels()
    for name in METHOD_MODULES:
        monkeypatch.setitem(sys.modules, name, fake_pipeline)
    monkeypatch.setattr(settings, "Params", FakeParams)
    monkeypatch.setattr(checkpoint, "code_digest", lambda module: "code")
    fake_pipeline.HOOKS.clear()
    fake_pipeline.LAST_CALL.clear()
    for name in RELOADED_MODULES:
        sys.modules.pop(name, None)
    yield fake_pipeline
    for name in RELOADED_MODULES:
        sys.modules.pop(name, None)


class Workspace:
    """A folder with photographs and params.yaml, and the command in it."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
        self.folder, self._monkeypatch, self._capsys = folder, monkeypatch, capsys
        self.transforms = sample_images.write_image_set(folder / "set")
        (folder / "params.yaml").write_text(PARAMS)
        self.out = folder / "cloud.ply"
        self.checkpoint = folder / "cloud.ply.checkpoint"

    def run(self, *arguments: object) -> tuple[int, str, str]:
        """Exit code, output and errors of the command with `arguments` and the usual ones."""
        cameras = ("--cameras", self.transforms)
        command_line = [
            *(() if "--sfm" in arguments and "--images" in arguments else cameras),
            *("--params", self.folder / "params.yaml"),
            *(() if "--out" in arguments else ("--out", self.out)),
            *arguments,
        ]
        self._monkeypatch.setattr(sys, "argv", ["reconstruct", *map(str, command_line)])
        try:
            code = command.main()
        except SystemExit as end:  # argparse
            code = end.code
        return code, *self._capsys.readouterr()

    def files(self) -> set[str]:
        """What lies in the folder, hidden files included."""
        return {path.name for path in self.folder.iterdir()}


@pytest.fixture
def workspace(tmp_path, monkeypatch, capsys, fake) -> Workspace:
    return Workspace(tmp_path, monkeypatch, capsys)
