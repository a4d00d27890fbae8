"""Reference pages say what holds now: dates and commits are of generated blocks and lab notes."""

import re
from pathlib import Path

import pytest

PAGES = sorted((Path(__file__).parents[2] / "docs/reference").glob("*.md"))
DATE_OR_COMMIT = r"\b20\d\d-\d\d-\d\d\b|\bcommit [0-9a-f]{7}\b"


def hand_written(text: str) -> str:
    """`text` without its generated blocks."""
    return re.sub(r"<!-- (\w+) -->.*?<!-- end \1 -->", "", text, flags=re.DOTALL)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_no_date_and_no_commit_is_written_by_hand(page: Path):
    assert not re.findall(DATE_OR_COMMIT, hand_written(page.read_text(encoding="utf-8")))


def test_a_date_beside_a_generated_block_is_found():
    text = "<!-- a -->\n2026-01-31\n<!-- end a -->\nas of 2026-01-31, commit 0123abc\n"
    assert re.findall(DATE_OR_COMMIT, hand_written(text)) == ["2026-01-31", "commit 0123abc"]
