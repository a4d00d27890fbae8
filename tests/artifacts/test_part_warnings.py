"""Warnings on parts: a file where there are some, and a line each in the terminal."""

import pytest

from industnerf.artifacts.part_warnings import (
    MAX_SHOWN_PARTS,
    load_part_warnings,
    print_part_warnings,
    save_part_warnings,
)
from industnerf.errors import BadArtifact


def test_a_part_without_warnings_has_no_file(tmp_path):
    for name, warnings in {"a": ["", "it is 60 m long"], "b": [""], "c": []}.items():
        (tmp_path / name).mkdir()
        save_part_warnings(tmp_path / name, warnings)
    assert [path.parent.name for path in tmp_path.glob("*/*")] == ["a"]
    assert load_part_warnings(tmp_path, "parts") == {"a": ["it is 60 m long"]}
    assert load_part_warnings(tmp_path / "none", "parts") == {}


def test_a_torn_file_names_the_stage_that_wrote_it(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "warnings.json").write_text("{")
    with pytest.raises(BadArtifact, match="parts"):
        load_part_warnings(tmp_path, "parts")


def test_each_is_a_line_and_of_many_parts_the_first_are_shown(tmp_path, capsys):
    for i in range(MAX_SHOWN_PARTS + 2):
        (tmp_path / f"{i:02d}").mkdir()
        save_part_warnings(tmp_path / f"{i:02d}", ["one", "two"])
    print_part_warnings(tmp_path, "views")
    lines = capsys.readouterr().out.splitlines()
    assert lines[:3] == ["views: 00: one", "views: 00: two", "views: 01: one"]
    assert len(lines) == 2 * MAX_SHOWN_PARTS + 1
    assert lines[-1] == f"views: warnings on 2 more: {tmp_path}/*/warnings.json"
