"""Published results agree with themselves, those that are committed too."""

import json
from pathlib import Path

import pytest

from industnerf.errors import BadArtifact
from industnerf.report.publish.study_folder import (
    COPIED_FILES,
    COPIED_FOLDERS,
    RUN_FILES,
    publish_study,
    readme_text,
)
from tests.report.report_samples import PROVENANCE, disagreements

RESULTS = Path(__file__).parents[3] / "results"
STUDY = RESULTS / "study"


def committed_studies():
    return [STUDY] if STUDY.exists() else []


def test_it_holds_the_tables_the_machine_and_the_commit(published):
    names = {path.name for path in published.iterdir()}
    extra = {"README.md", "made.json", "environment.json", "contact_sheet.png"}
    assert names == {*COPIED_FILES, *COPIED_FOLDERS, *RUN_FILES, *extra}
    assert json.loads((published / "made.json").read_text()) == PROVENANCE
    readme = (published / "README.md").read_text()
    assert "# Results of `make repro`" in readme
    assert all(f"`{name}`" in readme for name in COPIED_FILES)
    assert "![contact_sheet.png](contact_sheet.png)" in readme


def test_rebuilt_tables_are_said_to_be(published):
    assert "rebuilt" not in readme_text(published, PROVENANCE)
    rebuilt = PROVENANCE | {"rebuilt": {"date": "2026-02-03", "commit": "abcdef0"}}
    assert "rebuilt from its scores and costs on 2026-02-03, commit abcdef0" in readme_text(
        published, rebuilt
    )


@pytest.mark.parametrize("missing", ["reports/table2.csv", "dvc.lock"])
def test_what_is_published_stays_if_a_file_is_missing(published, missing):
    project = published.parents[1]
    (project / missing).unlink()
    with pytest.raises(BadArtifact, match=missing):
        publish_study(project / "reports", published, PROVENANCE, project)
    assert (published / "table1.csv").exists()


def test_what_was_there_before_goes(published):
    (published / "old.csv").touch()
    publish_study(published.parents[1] / "reports", published, PROVENANCE, published.parents[1])
    assert not (published / "old.csv").exists()


def test_what_is_interrupted_leaves_what_was_there(published, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("industnerf.report.publish.study_folder.environment", interrupted)
    with pytest.raises(KeyboardInterrupt):
        publish_study(published.parents[1] / "reports", published, PROVENANCE, published.parents[1])
    assert (published / "environment.json").exists()


def test_a_report_that_lacks_a_file_changes_nothing(published):
    report = published.parents[1] / "reports"
    (report / "strata.csv").unlink()
    with pytest.raises(BadArtifact, match=r"strata\.csv is missing"):
        publish_study(report, published, PROVENANCE, published.parents[1])
    assert (published / "strata.csv").exists()


def test_published_tables_are_those_of_the_published_scores(published):
    for folder in [published, *(path.parent for path in RESULTS.glob("*/table1.csv"))]:
        assert disagreements(folder) == []


@pytest.mark.parametrize(
    ("name", "column"),
    [
        ("table1.csv", "emd_even"),
        ("table1.csv", "emd_full"),
        ("table1.csv", "failures"),
        ("table2.csv", "value"),
        ("comparisons.csv", "difference"),
        ("comparisons.csv", "p"),
        ("comparisons.csv", "p_holm"),
        ("comparisons.csv", "win_rate"),
        ("strata.csv", "floor"),
    ],
)
def test_a_number_that_was_touched_is_found(published, name, column):
    lines = (published / name).read_text().splitlines()
    at = lines[0].split(",").index(column)
    cells = lines[1].split(",")
    cells[at] = str(float(cells[at]) + 0.001)
    (published / name).write_text("\n".join([lines[0], ",".join(cells), *lines[2:]]))
    (disagreement,) = disagreements(published)
    assert disagreement.startswith(f"{name}: ")
    assert f" {column} is {cells[at]}" in disagreement


def test_committed_results_are_small_enough_for_a_repository():
    for folder in committed_studies():
        assert sum(path.stat().st_size for path in folder.glob("*.png")) < 1_500_000
