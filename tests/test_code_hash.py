"""The digest of code: what it follows, and what it must not mind."""

import sys
from importlib.metadata import version

import pytest

from industnerf import code_hash


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A package of three modules, named like ours so that imports of it are followed."""
    folder = tmp_path / "toy_suite"
    folder.mkdir()
    (folder / "__init__.py").write_text("")
    (folder / "top.py").write_text("from toy_suite.middle import f\n")
    (folder / "middle.py").write_text(
        "def f():\n    from toy_suite import bottom\n    return bottom.X\n"
    )
    (folder / "bottom.py").write_text("X = 1\n")
    (folder / "aside.py").write_text("Y = 1\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(code_hash, "PACKAGE", "toy_suite")
    yield folder
    for name in [name for name in sys.modules if name.startswith("toy_suite")]:
        del sys.modules[name]


def fresh_digest() -> str:
    for cached in (
        code_hash.source_path,
        code_hash._imports,
        code_hash.library_versions,
        code_hash.import_closure,
        code_hash.code_digest,
    ):
        cached.cache_clear()
    return code_hash.code_digest("toy_suite.top")


def test_late_imports_are_followed(package):
    fresh_digest()
    assert code_hash.import_closure("toy_suite.top") == {
        "toy_suite.top",
        "toy_suite.middle",
        "toy_suite.bottom",
    }


def test_a_change_anywhere_below_counts(package):
    before = fresh_digest()
    (package / "bottom.py").write_text("X = 2\n")
    assert fresh_digest() != before


@pytest.mark.parametrize("text", ["X = 1  # a comment\n", '"""A docstring."""\n\nX = 1\n'])
def test_words_do_not_count(package, text):
    before = fresh_digest()
    (package / "bottom.py").write_text(text)
    assert fresh_digest() == before


def test_a_module_that_is_not_imported_does_not_count(package):
    before = fresh_digest()
    (package / "aside.py").write_text("Y = 2\n")
    assert fresh_digest() == before


def test_libraries_are_those_of_the_whole_closure(package):
    """By their names in the package index; types, Python's own and the suite's do not count."""
    (package / "bottom.py").write_text(
        "import os, ot.lp\nfrom jaxtyping import Float\nimport no_such_library\nX = 1\n"
    )
    (package / "aside.py").write_text("import torch\n")
    fresh_digest()
    assert code_hash.library_versions(("toy_suite.top",)) == {"POT": version("POT")}
