"""The tables of results/ are what today's code makes of the scores beside them."""

from pathlib import Path

import pytest

from pipeline.retable import tables

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    "name", sorted(path.parent.name for path in ROOT.glob("results/*/scores.csv"))
)
def test_a_published_table_is_made_of_the_scores_beside_it(name: str, monkeypatch):
    """If not: python -m pipeline.retable results/<name>"""
    monkeypatch.chdir(ROOT)
    folder = Path("results") / name
    differ = [file for file, text in tables(folder).items() if (folder / file).read_text() != text]
    assert differ == []
