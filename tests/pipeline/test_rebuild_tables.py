"""The tables of results/ are what today's code makes of the scores beside them."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from industnerf.errors import BadArtifact
from industnerf.parts.catalogue.entries import to_part
from industnerf.report.build import table_texts
from industnerf.report.publish.study_folder import readme_text
from pipeline import rebuild_tables
from pipeline.rebuild_tables import rebuilt_results

ROOT = Path(__file__).parents[2]
STUDIES = sorted(path.parent.name for path in ROOT.glob("results/*/scores.csv"))


@pytest.mark.parametrize("name", STUDIES)
def test_a_published_table_is_made_of_the_scores_beside_it(name: str, monkeypatch):
    """If not: python -m pipeline.rebuild_tables results/<name>"""
    monkeypatch.chdir(ROOT)
    folder = Path("results") / name
    differ = [
        file
        for file, text in table_texts(rebuilt_results(folder)).items()
        if (folder / file).read_text() != text
    ]
    assert differ == []


def test_a_table_made_anew_leaves_a_trace(monkeypatch, tmp_path):
    """The commit that measured the scores stays beside that of the tables."""
    shutil.copytree(ROOT / "results/organic", tmp_path / "organic")
    monkeypatch.chdir(ROOT)
    provenance = json.loads((tmp_path / "organic/made.json").read_text())
    provenance.pop("rebuilt", None)
    monkeypatch.setattr(
        rebuild_tables, "commit_stamp", lambda: {"date": "2026-01-02", "commit": "0123456"}
    )
    (tmp_path / "organic/table1.md").write_text("old")
    rebuild_tables.main(str(tmp_path / "organic"))
    rebuilt = {"date": "2026-01-02", "commit": "0123456"}
    assert json.loads((tmp_path / "organic/made.json").read_text()) == provenance | {
        "rebuilt": rebuilt
    }
    assert " on 2026-01-02, commit 0123456, " in (tmp_path / "organic/README.md").read_text()
    assert (tmp_path / "organic/table1.md").read_text() != "old"


def test_parts_of_another_size_than_those_scored_are_refused(monkeypatch, tmp_path):
    shutil.copytree(ROOT / "results/organic", tmp_path / "organic")
    monkeypatch.chdir(ROOT)

    def larger(recipe):
        part = to_part(recipe)
        return replace(part, extents_mm=tuple(1.01 * side for side in part.extents_mm))

    monkeypatch.setattr(rebuild_tables, "to_part", larger)
    before = (tmp_path / "organic/table1.md").read_bytes()
    with pytest.raises(BadArtifact, match=r"was [\d.]+ mm.* another size"):
        rebuild_tables.main(str(tmp_path / "organic"))
    assert (tmp_path / "organic/table1.md").read_bytes() == before


def test_the_parts_of_a_preset_are_found_from_where_it_ran(monkeypatch, tmp_path):
    """In runs/organic the place of parts is two folders up, and no folder of results."""
    shutil.copytree(ROOT / "results/organic", tmp_path / "organic")
    params = tmp_path / "organic/params.yaml"
    original_text = params.read_text()
    params.write_text(original_text.replace("path: data/organic", "path: ../../data/organic"))
    assert params.read_text() != original_text
    monkeypatch.chdir(ROOT)
    moved, published = (
        rebuilt_results(path) for path in (tmp_path / "organic", Path("results/organic"))
    )
    assert table_texts(moved) == table_texts(published)


@pytest.mark.parametrize("name", STUDIES)
def test_what_is_said_of_a_published_folder_is_what_was_done(name: str):
    folder = ROOT / "results" / name
    provenance = json.loads((folder / "made.json").read_text())
    assert (folder / "README.md").read_text() == readme_text(folder, provenance)
