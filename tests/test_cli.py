"""The command line of a stage that is called by hand."""

import sys
from pathlib import Path

import pytest

from industnerf.cli import require_dvc, run_as_stage, run_command
from industnerf.errors import BadParams
from pipeline import check, grid, preset, publish, publish_weights, score, sweep_docs

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize("arguments", [[], ["data/parts"], ["data/parts", "data/views", "more"]])
def test_other_arguments_than_the_stage_takes_are_refused_in_words(arguments, monkeypatch, capsys):
    def main(cfg, parts, out):
        raise AssertionError("not to be reached")

    monkeypatch.setattr(sys, "argv", ["pipeline/stages/views.py", *arguments])
    with pytest.raises(SystemExit) as end:
        run_as_stage(main, "views")
    assert end.value.code == 2
    stderr = capsys.readouterr().err
    assert (
        f"python -m pipeline.stages.views takes PARTS OUT, {len(arguments)} arguments were given"
        in stderr
    )
    assert "`dvc repro views`" in stderr


def test_those_that_it_takes_reach_it_with_its_parameters(monkeypatch):
    calls = []
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(sys, "argv", ["pipeline/stages/views.py", "data/parts", "data/views"])
    run_as_stage(lambda cfg, parts, out: calls.append((cfg.views.count, parts, out)), "views")
    assert calls == [(40, "data/parts", "data/views")]


@pytest.mark.parametrize(("module", "arguments"), [(preset, []), (publish, ["a", "b"])])
def test_a_command_with_other_arguments_says_its_usage(module, arguments, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", [module.__name__, *arguments])
    with pytest.raises(SystemExit) as end:
        run_command(module.main)
    assert end.value.code == 2
    stderr = capsys.readouterr().err
    assert f"{len(arguments)} arguments were given" in stderr
    assert f"python -m {module.__name__}" in stderr


def test_without_the_environment_dvc_is_asked_for(monkeypatch):
    monkeypatch.setenv("PATH", "")
    with pytest.raises(BadParams, match=r"source \.venv/bin/activate"):
        require_dvc()


@pytest.mark.parametrize(
    "module", [check, grid, preset, score, publish, publish_weights, sweep_docs]
)
def test_help_prints_what_the_command_takes(module, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", [module.__name__, "--help"])
    run_command(module.main)
    printed = capsys.readouterr()
    assert f"python -m {module.__name__}" in printed.out
    assert not printed.err


def test_keyword_parameters_are_options_wherever_they_stand(monkeypatch, capsys):
    calls = []

    def main(path, *, min_opacity="0"):
        calls.append((path, min_opacity))

    for arguments in (["a"], ["--min-opacity", "0.5", "a"], ["a", "--min-opacity=0.7"]):
        monkeypatch.setattr(sys, "argv", ["score", *arguments])
        run_command(main)
    assert calls == [("a", "0"), ("a", "0.5"), ("a", "0.7")]
    monkeypatch.setattr(sys, "argv", ["score", "a", "--max-opacity=1"])
    with pytest.raises(SystemExit):
        run_command(main)
