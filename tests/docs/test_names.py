"""What the documents name in the code is there."""

import importlib
import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs/reference"


@pytest.mark.parametrize(
    ("document", "least"), [("method.md", 10), ("readings.md", 10), ("scaling.md", 3)]
)
def test_every_module_and_function_that_is_named_exists(document: str, least: int):
    names = re.findall(r"`(industnerf\.[\w.]+)`", (DOCS / document).read_text(encoding="utf-8"))
    assert len(names) >= least
    for name in names:
        assert resolve(name), name


def resolve(name: str):
    """The module, or what a module holds, of a dotted name; None if there is no such thing."""
    parts = name.split(".")
    for end in range(len(parts), 0, -1):
        try:
            resolved = importlib.import_module(".".join(parts[:end]))
        except ModuleNotFoundError:
            continue
        for attribute in parts[end:]:
            resolved = getattr(resolved, attribute, None)
        return resolved
    return None


def test_a_name_that_is_not_there_is_found_out():
    assert resolve("industnerf.metrics.emd.emd")
    assert resolve("industnerf.metrics.emd.emdd") is None
