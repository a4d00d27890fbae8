"""docs/reference/readings.md says what the code can do, all of it, and nothing else."""

import re
from dataclasses import fields
from pathlib import Path
from pkgutil import resolve_name
from typing import get_args, get_type_hints

import pytest

from industnerf.config import load_params
from industnerf.report.docs.markdown_blocks import read_block
from industnerf.report.docs.protocol_readings import PROTOCOL_VARIANTS
from industnerf.schema.readings import READING_IDS, Readings

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs/reference/readings.md").read_text(encoding="utf-8")
SECTIONS = {part.split(":")[0]: part for part in re.split(r"^## ", TEXT, flags=re.MULTILINE)[1:]}
HINTS = get_type_hints(Readings)
LITERALS = {name: set(get_args(hint)) for name, hint in HINTS.items()}
ROW = r"^\| `(\w+)`(?: \(\*\*default\*\*\))? \|"
FUNCTION = r"(?:^Key `\w+`, function|; its twin is)\s`(industnerf\.[\w.]+)`"
DEFAULT = r"^\| `(\w+)` \(\*\*default\*\*\) \|"


def find_all(pattern: str, text: str) -> list[str]:
    return re.findall(pattern, text, re.MULTILINE)


def test_there_are_sixteen_sections_and_a_number_for_every_field():
    assert [name for name in SECTIONS if name.startswith("R")] == [f"R{i}" for i in range(1, 17)]
    assert list(READING_IDS) == [field.name for field in fields(Readings)]


@pytest.mark.parametrize("field", LITERALS)
def test_a_section_names_its_key_its_readings_and_the_default(field: str):
    section = SECTIONS[READING_IDS[field]]
    settings = load_params(ROOT / "params.yaml").method.industnerf.readings
    assert f"Key `{field}`, " in section
    rows = find_all(ROW, section)
    assert sorted(rows) == sorted(LITERALS[field])
    assert find_all(DEFAULT, section) == [getattr(settings, field)]


@pytest.mark.parametrize("field", LITERALS)
def test_the_function_that_a_section_names_takes_the_reading(field: str):
    """Of R7 it is the twin of what is compiled."""
    (name,) = find_all(FUNCTION, SECTIONS[READING_IDS[field]])
    assert HINTS[field] in get_type_hints(resolve_name(name)).values()


def test_methods_and_rendering_compare_in_so_many_words_no_reading_but_r4():
    """As `readings.x ==`, `!=` or `in`; what is handed on under another name is not seen.

    Of signed distances (R4) beta falls as they are learned, and none is truncated.
    """
    folders = [ROOT / "src/industnerf" / name for name in ("methods", "rendering", "reconstruct")]
    texts = [path.read_text() for folder in folders for path in folder.rglob("*.py")]
    compared = [name for text in texts for name in find_all(r"readings\.(\w+) (?:[!=]=|in)", text)]
    assert set(compared) == {"density_activation"}


def test_sections_without_a_key_are_those_that_the_metrics_answer():
    keyless = [name for name, text in SECTIONS.items() if "No key. " in text]
    assert keyless == ["R12", "R13"]
    assert set(READING_IDS.values()).isdisjoint(keyless)


def test_every_reading_has_a_row_for_its_effect():
    rows = find_all(r"^\| (R\d+) \| `(\w+)` \|", read_block(TEXT, "readings"))
    expected = {
        (READING_IDS[field], value) for field, values in LITERALS.items() for value in values
    }
    assert len(rows) == len(set(rows))
    assert set(rows) == expected


def test_what_the_metrics_answer_has_rows_for_its_effect_too():
    measuring_table = read_block(TEXT, "measuring")
    rows = find_all(r"^\| (R\d+) \| `([^`]+)` \|", measuring_table)
    assert {number for number, _ in rows} == {"R12", "R13"}
    named = set(find_all(r"`(P1-\w+)`", SECTIONS["R12"]))
    assert {reading for number, reading in rows if number == "R12"} == named
    assert {reading for number, reading in rows if number == "R13"} == set(PROTOCOL_VARIANTS)
