"""The spread over seeds is brought under version control, from sweeps that are whole."""

import json
import shutil
from pathlib import Path

import pytest

from industnerf.artifacts.files import write_json
from industnerf.errors import BadArtifact
from pipeline import spread
from tests.report.test_spread import sweep

RESULTS = Path(__file__).parents[2] / "results"


@pytest.fixture
def seeds(tmp_path, monkeypatch):
    """A finished sweep over two seeds, made at another commit than today's."""
    monkeypatch.chdir(tmp_path)
    folder = sweep(tmp_path / "seeds", ["part-1", "part-2"], ["hull"])
    for seed in "01":
        (folder / seed / "params.yaml").write_text("preset: seeds\n")
        (folder / seed / "reports/summary.json").write_text("{}")
    (folder / "sweep.csv").touch()
    write_json(folder / "made.json", {"schema": 1, "date": "2026-01-02", "commit": "0123456"})
    return folder


def test_it_says_where_each_sweep_was_made(seeds, tmp_path):
    spread.main(str(seeds))
    made = json.loads((tmp_path / "results/seeds/made.json").read_text())
    assert made["sweeps"]["seeds"]["commit"] == "0123456"
    assert "hull" in (tmp_path / "results/seeds/seeds.md").read_text()


def test_a_sweep_of_which_a_point_failed_is_refused(seeds, tmp_path):
    (seeds / "1/reports/summary.json").unlink()
    with pytest.raises(BadArtifact, match=r"1 points of .* have no report"):
        spread.main(str(seeds))
    assert not (tmp_path / "results").exists()


def test_a_sweep_of_something_else_is_refused(seeds, tmp_path):
    (seeds / "0/params.yaml").write_text("preset: smoke\n")
    (seeds / "1/params.yaml").write_text("preset: smoke\n")
    with pytest.raises(BadArtifact, match="is of preset 'smoke', not of experiment=seeds"):
        spread.main(str(seeds))
    assert not (tmp_path / "results").exists()


def test_the_committed_tables_are_written_anew_as_they_are(monkeypatch, tmp_path):
    """If not: python -m pipeline.spread"""
    for name in ("seeds/seeds.csv", "seeds/seeds.md", "study/scores.csv"):
        (tmp_path / "results" / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(RESULTS / name, tmp_path / "results" / name)
    monkeypatch.chdir(tmp_path)
    spread.main()
    for name in ("seeds.csv", "seeds.md"):
        assert Path("results/seeds", name).read_text() == (RESULTS / "seeds" / name).read_text()
