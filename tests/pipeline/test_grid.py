"""The grid of protocols over what a finished run left."""

import csv
import json
import os
import subprocess
from dataclasses import replace

import pytest

from industnerf.config import load_params
from industnerf.errors import BadArtifact, BadParams
from industnerf.metrics import protocol_grid
from industnerf.report.tables.protocol_grid import CELL_KEYS
from pipeline import grid

pytestmark = pytest.mark.slow  # of a finished run
GIT_IDENTITY = ("-c", "user.name=n", "-c", "user.email=e@example.org")


@pytest.fixture
def study(finished_run, tmp_path, monkeypatch):
    """The finished run's data and parameters, with two of its methods as subjects."""
    for name in ("data", "params.yaml", "dvc.yaml"):
        os.symlink(finished_run.folder / name, tmp_path / name)
    for command in (["init", "-q"], ["commit", "-q", "--allow-empty", "-m", "first"]):
        subprocess.run(["git", *GIT_IDENTITY, *command], cwd=tmp_path, check=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("INDUSTNERF_RUNNER", "serial")  # workers would not hear of these:
    monkeypatch.setattr(grid, "METHODS", ("oracle", "hull"))
    monkeypatch.setattr(grid, "check_finished", lambda *_, **__: None)  # there is no DVC here
    monkeypatch.setattr(protocol_grid, "POINT_COUNTS", (32, 64))
    monkeypatch.setattr(protocol_grid, "LARGE_POINT_COUNTS", (96,))
    return tmp_path


def test_a_study_becomes_a_table_of_protocols(study):
    grid.main()
    with (study / "results" / "grid" / "grid.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert {row["subject"] for row in rows} == {"floor", "oracle", "hull"}
    # 3 numbers of points, 2 reductions, 2 surfaces, 2 costs, 2 scales, 3 subjects
    assert len(rows) == 3 * 2 * 2 * 2 * 2 * 3
    row_at = {(*(r[name] for name in r if name in CELL_KEYS), r["subject"]): r for r in rows}
    default_cell = ("64", "even", "visible", "distance", "diagonal")
    assert (
        float(row_at[*default_cell, "hull"]["mean"])
        > float(row_at[*default_cell, "floor"]["mean"])
        > 0
    )
    # what is the truth itself scores as its floor does: both are samples of it
    ratio = float(row_at[*default_cell, "oracle"]["mean"]) / float(
        row_at[*default_cell, "floor"]["mean"]
    )
    assert ratio == pytest.approx(1, abs=0.2)
    assert (study / "results" / "grid" / "grid.md").read_text().count("\n") == 2 + 48
    provenance = json.loads((study / "results" / "grid" / "made.json").read_text())
    assert provenance["command"] == "python -m pipeline.grid"


def test_what_is_done_is_done_once(study, capsys):
    grid.main()
    assert "2 made, 0 reused" in capsys.readouterr().out
    grid.main()
    assert "0 made, 2 reused" in capsys.readouterr().out


def test_own_parts_do_not_replace_the_grid_of_the_study(study, monkeypatch):
    own_params = load_params()
    own_params = replace(
        own_params, parts=replace(own_params.parts, source="path", path="my-parts")
    )
    monkeypatch.setattr(grid, "load_params", lambda: own_params)
    with pytest.raises(BadParams, match=r"parts\.path is my-parts"):
        grid.main()
    assert not (study / "results").exists()


def test_without_clouds_it_says_what_to_run(study, monkeypatch):
    monkeypatch.setattr(grid, "METHODS", ("oracle", "nobody"))
    with pytest.raises(BadArtifact, match=r"no cloud of nobody: `make repro`"):
        grid.main()
