"""Retired words do not come back in names."""

import re
from pathlib import Path

import pytest

from tests.docs.names import names_by_file, python_names, words

ROOT = Path(__file__).parents[2]
RETIRED = (ROOT / "docs/lab/names.md").read_text(encoding="utf-8")


def retired_words() -> set[str]:
    """The words of the first column of the last table."""
    rows = re.findall(r"^\| (`.*?`) \|", RETIRED.split("## Retired words")[1], re.MULTILINE)
    return {word for row in rows for word in re.findall(r"`(\w+)`", row)}


def test_no_name_has_a_retired_word():
    retired, found = retired_words(), []
    for path, names in names_by_file(ROOT):
        found += [f"{path}: {name}" for name in names if retired.intersection(words(name))]
    assert sorted(found) == []


def test_there_are_retired_words_and_each_is_listed_once():
    rows = re.findall(r"`(\w+)`", RETIRED.split("## Retired words")[1])
    assert len(rows) > 50
    assert len(rows) == len(set(rows))


@pytest.mark.parametrize(
    ("source", "names"),
    [
        ("def tell(witness, *, trust=1, **doubts): pass", {"tell", "witness", "trust", "doubts"}),
        ("class Pupil:\n    school: int = 1", {"Pupil", "school"}),
        ("for lesson in b: self.veil = [album for album in c]", {"lesson", "veil", "album"}),
        ("import a as told\nwith open(b) as heard: pass", {"told", "heard"}),
        ("print(witness, 'trust')  # doubt", set()),
        ("def test_that_doubts_are_named(): pass", set()),
    ],
)
def test_names_are_those_that_are_bound(source: str, names: set[str]):
    assert python_names(source) == names


def test_words_of_a_name_are_found_in_any_case():
    assert words("MaxTrust_px") == ["max", "trust", "px"]
    assert words("_EMDWitness2") == ["emd", "witness"]
