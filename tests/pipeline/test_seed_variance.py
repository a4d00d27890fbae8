"""The spread over seeds is brought under version control, from sweeps that are whole."""

import json
import shutil
from pathlib import Path

import pytest

from industnerf.artifacts.files import write_json
from industnerf.errors import BadArtifact
from industnerf.report.statistics.seed_variance import read_seed_variances
from pipeline import seed_variance
from tests.report.statistics.test_seed_variance import write_sweep

RESULTS = Path(__file__).parents[2] / "results"


@pytest.fixture
def seeds(tmp_path, monkeypatch):
    """A finished sweep over two seeds, made at another commit than today's."""
    monkeypatch.chdir(tmp_path)
    return make_finished_sweep(tmp_path / "seeds", "hull")


def make_finished_sweep(folder, method):
    """The folder of a finished sweep of the preset that is called as it is."""
    write_sweep(folder, ["part-1", "part-2"], [method])
    for seed in "01":
        (folder / seed / "params.yaml").write_text(f"preset: {folder.name}\n")
        (folder / seed / "reports/summary.json").write_text("{}")
    (folder / "sweep.csv").touch()
    write_json(folder / "made.json", {"schema": 1, "date": "2026-01-02", "commit": "0123456"})
    return folder


def test_it_says_where_each_sweep_was_made(seeds, tmp_path):
    seed_variance.main(str(seeds))
    provenance = json.loads((tmp_path / "results/seeds/made.json").read_text())
    assert provenance["sweeps"]["seeds"]["commit"] == "0123456"
    assert "hull" in (tmp_path / "results/seeds/seeds.md").read_text()


def test_other_methods_and_sweeps_stay_as_they_are(seeds, tmp_path):
    """Those of nets and those of the others are measured apart."""
    seed_variance.main(str(seeds))
    seed_variance.main(str(make_finished_sweep(tmp_path / "seeds_nets", "r2n2")))
    rows = read_seed_variances(tmp_path / "results/seeds")
    assert {row.method for row in rows} == {"hull", "r2n2"}
    provenance = json.loads((tmp_path / "results/seeds/made.json").read_text())
    assert set(provenance["sweeps"]) == {"seeds", "seeds_nets"}
    assert provenance["sweeps"]["seeds"]["methods"] == ["hull"]


def test_a_sweep_that_is_run_again_without_a_method_no_longer_has_it(seeds, tmp_path):
    """Else its row would seem to be of today's commit."""
    seed_variance.main(str(seeds))
    for path in seeds.glob("*/reports/scores.csv"):
        path.write_text(path.read_text().replace("hull", "carve"))
    seed_variance.main(str(seeds))
    assert [row.method for row in read_seed_variances(tmp_path / "results/seeds")] == ["carve"]


def test_mm_that_a_sweep_measured_outlive_a_study_with_other_clouds(seeds, tmp_path):
    seed_variance.main(str(seeds))
    table = tmp_path / "results/seeds/seeds.csv"
    text_with_mm = table.read_text().rstrip("\n") + "1.25\n"
    table.write_text(text_with_mm)
    seed_variance.main()
    assert table.read_text() == text_with_mm


def test_without_a_sweep_there_must_be_a_table(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadArtifact, match="name the sweeps that measured the spread"):
        seed_variance.main()


def test_a_sweep_of_which_a_point_failed_is_refused(seeds, tmp_path):
    (seeds / "1/reports/summary.json").unlink()
    with pytest.raises(BadArtifact, match=r"1 points of .* have no report"):
        seed_variance.main(str(seeds))
    assert not (tmp_path / "results").exists()


def test_a_sweep_of_something_else_is_refused(seeds, tmp_path):
    (seeds / "0/params.yaml").write_text("preset: smoke\n")
    (seeds / "1/params.yaml").write_text("preset: smoke\n")
    with pytest.raises(BadArtifact, match="is of preset 'smoke', not of experiment=seeds"):
        seed_variance.main(str(seeds))
    assert not (tmp_path / "results").exists()


def test_the_committed_tables_are_written_anew_as_they_are(monkeypatch, tmp_path):
    """If not: python -m pipeline.seed_variance"""
    for name in ("seeds/seeds.csv", "seeds/seeds.md", "seeds/made.json", "study/scores.csv"):
        (tmp_path / "results" / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(RESULTS / name, tmp_path / "results" / name)
    monkeypatch.chdir(tmp_path)
    seed_variance.main()
    for name in ("seeds.csv", "seeds.md"):
        assert Path("results/seeds", name).read_text() == (RESULTS / "seeds" / name).read_text()
