"""User pages are short: at most 100 lines of README, and 18 words a sentence on average."""

import re
from pathlib import Path
from statistics import fmean

import pytest

ROOT = Path(__file__).parents[2]
README, MAX_LINES, MAX_WORDS = ROOT / "README.md", 100, 18
USER_PAGES = [
    README,
    ROOT / "CONTRIBUTING.md",
    *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "docs/how-to").glob("*.md")),
]
NOT_PROSE = re.compile(r"```.*?```|<!--.*?-->|^\s*(?:\||#|!|<).*?$|^ {4}.*?$", re.M | re.S)
DATE = re.compile(r"\b20\d\d-\d\d-\d\d\b")


def sentences(text: str) -> list[str]:
    """The sentences of Markdown; code counts as one word, and of a link its text."""
    text = re.sub(r"`[^`]*`", "X", NOT_PROSE.sub("", text))
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    return [part for part in re.split(r"(?<=[.!?:])\s+|\n\n", text) if len(part.split()) > 2]


def written_by_hand(text: str) -> str:
    return re.sub(r"<!-- (\w+) -->.*?<!-- end \1 -->", "", text, flags=re.DOTALL)


def test_the_readme_fits_on_three_screens():
    assert len(README.read_text(encoding="utf-8").splitlines()) <= MAX_LINES


@pytest.mark.parametrize("page", USER_PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_sentences_are_short(page: Path):
    lengths = [len(part.split()) for part in sentences(page.read_text(encoding="utf-8"))]
    assert fmean(lengths) <= MAX_WORDS


@pytest.mark.parametrize("page", USER_PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_only_generated_lines_have_dates(page: Path):
    assert DATE.findall(written_by_hand(page.read_text(encoding="utf-8"))) == []


def test_a_long_sentence_is_counted():
    text = "# Title\n\nOne two three. `a b c` and [four five](x.md) six!\n\n    code is no prose\n"
    assert [len(part.split()) for part in sentences(text)] == [3, 5]
