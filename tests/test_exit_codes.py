"""Bad input ends every command with the same exit code, and one sentence."""

import runpy
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from industnerf import errors
from industnerf.cli import exit_with_message
from industnerf.errors import ReconstructionFailed, RegionInsteadOfPart, SuiteError

ROOT = Path(__file__).parents[1]
BAD_COMMAND_LINES = [
    "industnerf.deviation none.ply none.step",
    "industnerf.doctor no-such-check",
    "industnerf.parts export no-such-part --format stl --out out",
    "industnerf.parts check docs/api",
    "industnerf.parts.procedural export --count 0 --out out",
    "industnerf.reconstruct --cameras none.json --out out.ply",
    "industnerf.tracking nothing-is-logged-here",
    "industnerf.view none.ply",
    "pipeline.grid one-argument-too-many",
    "pipeline.preset no-such-preset",
    "pipeline.publish one two",
    "pipeline.score none.ply gear-spur-m2-z24",
    "pipeline.stages.views too few many arguments",
    "pipeline.sweep views.cuont=8",
]


@pytest.mark.parametrize("command_line", BAD_COMMAND_LINES, ids=lambda text: text.split()[0])
def test_bad_input_ends_with_code_2(command_line, monkeypatch, capsys):
    module, *arguments = command_line.split()
    monkeypatch.chdir(ROOT)
    monkeypatch.setenv("INDUSTNERF_MLFLOW", "off")
    monkeypatch.setattr(sys, "argv", [module, *arguments])
    is_package = find_spec(module).submodule_search_locations is not None
    run = f"{module}.__main__" if is_package else module
    monkeypatch.delitem(sys.modules, run, raising=False)  # it may not be run and be imported too
    with pytest.raises(SystemExit) as end:
        runpy.run_module(module, run_name="__main__")
    assert end.value.code == 2
    text = capsys.readouterr().err
    assert "error: " in text
    assert "Traceback" not in text


def every_error(kind: type[SuiteError] = SuiteError):
    yield kind
    for below in kind.__subclasses__():
        yield from every_error(below)


@pytest.mark.parametrize("kind", list(every_error()))
def test_what_was_given_is_told_from_what_went_wrong(kind, capsys):
    """2 for input, 3 for a result that is no part, 1 for all else that failed."""
    inputs = (errors.BadParams, errors.BadPart, errors.BadArtifact)
    expected = 2 if issubclass(kind, inputs) else 3 if kind is RegionInsteadOfPart else 1

    def refuse() -> None:
        raise kind("no")

    with pytest.raises(SystemExit) as end:
        exit_with_message(refuse)
    assert (end.value.code, kind.exit_code) == (expected, expected)
    assert capsys.readouterr().err == "error: no\n"


def test_the_codes_are_documented_in_one_place():
    page = (ROOT / "docs/reference/environment.md").read_text(encoding="utf-8")
    rows = {line.split("|")[1].strip() for line in page.splitlines() if line.startswith("| ")}
    codes = {kind.exit_code for kind in every_error()} | {0, 130}
    assert {str(code) for code in codes} <= rows
    assert issubclass(RegionInsteadOfPart, ReconstructionFailed)
