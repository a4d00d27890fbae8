"""The list of hyper-parameters: complete, and right about who reads what."""

import re
from pathlib import Path

import pytest

from industnerf import config
from industnerf.config import flatten
from industnerf.report.docs.hyperparameters.document import (
    escape_cell,
    format_value,
    reader_stages,
    render_document,
)
from industnerf.report.docs.hyperparameters.paper_symbols import PAPER_SYMBOLS


@pytest.fixture
def stages(root: Path) -> dict:
    return config.load_stages(root / "dvc.yaml")


@pytest.mark.parametrize(
    ("key", "expected"),
    [
        ("views.light.ambient", ["views", "procedural"]),
        ("views.count", ["views", "procedural", "report"]),
        ("method.hull.points", ["reconstruct"]),
        ("method.r2n2.size", ["pretrain", "train", "reconstruct"]),
        ("parts.units", ["solids"]),
        ("parts.path", ["solids", "parts"]),  # it stands in their commands
        ("methods", ["procedural", "pretrain", "train", "reconstruct", "evaluate", "report"]),
        ("preset", ["report"]),
    ],
)
def test_who_reads_a_parameter_is_what_dvc_says(key: str, expected: list[str], stages: dict):
    assert reader_stages(key, stages) == expected


def test_somebody_reads_every_parameter(root: Path, stages: dict):
    values_by_key = flatten(config.read_yaml(root / "params.yaml"), split_lists=True)
    assert [key for key in values_by_key if not reader_stages(key, stages)] == []


def test_what_has_a_symbol_is_a_parameter(root: Path):
    values_by_key = flatten(config.read_yaml(root / "params.yaml"), split_lists=True)
    assert set(PAPER_SYMBOLS) <= set(values_by_key)


def test_every_parameter_is_in_the_document_with_its_value(root: Path, stages: dict):
    values, text = config.read_yaml(root / "params.yaml"), (root / "params.yaml").read_text()
    rows = re.findall(r"^\| `(.+?)` \| (.*)$", render_document(text, values, stages), re.MULTILINE)
    cells = {(name, cell) for name, row in rows for cell in row.split(" | ")}
    for key, value in flatten(values, split_lists=True).items():
        names = [key, key.split(".", 1)[-1], key.split(".", 2)[-1]]
        assert any((name, format_value(value)) in cells for name in names), key


def test_values_are_shown_as_the_file_has_them():
    assert [format_value(v) for v in (True, 1.0e-6, 3, "max", [0.5, 1.0])] == [
        "`true`",
        "`1e-06`",
        "`3`",
        "`max`",
        "`[0.5, 1]`",
    ]


def test_a_cell_cannot_end_its_column():
    assert escape_cell("a | b*") == "a \\| b\\*"
