"""The names that this repository gives: of modules, classes, functions, variables and keys."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

PYTHON_FOLDERS = ("src", "pipeline", "tests", "benchmarks")
YAML_FILES = ("params.yaml", "conf/**/*.yaml")
WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")


def names_by_file(root: Path) -> Iterator[tuple[Path, set[str]]]:
    """Each file below `root` with the names that it defines, its own name among them.

    Strings, comments and what a file only uses do not count, and of tests neither do their titles.
    """
    for folder in PYTHON_FOLDERS:
        for path in sorted((root / folder).rglob("*.py")):
            names = python_names(path.read_text(encoding="utf-8"))
            yield path.relative_to(root), {path.stem, path.parent.name} | names
    for pattern in YAML_FILES:
        for path in sorted(root.glob(pattern)):
            content = yaml.safe_load(path.read_text(encoding="utf-8"))
            yield path.relative_to(root), {path.stem} | set(keys(content))


def python_names(source: str) -> set[str]:
    """Every name that `source` binds, without those of test functions."""
    names = set()
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                names.add("" if name.startswith("test_") else name)
            case ast.arg(arg=name) | ast.alias(asname=str(name)):
                names.add(name)
            case ast.Name(id=name, ctx=ast.Store()) | ast.Attribute(attr=name, ctx=ast.Store()):
                names.add(name)
    return names - {""}


def keys(content: Any) -> Iterator[str]:
    """All keys of nested mappings, the parts of dotted ones apart."""
    if isinstance(content, dict):
        for key, value in content.items():
            yield from str(key).split(".")
            yield from keys(value)
    elif isinstance(content, list):
        for value in content:
            yield from keys(value)


def words(name: str) -> list[str]:
    """The words of a name, in lower case: `SweepEnd` and `sweep_end` have two."""
    return [word.lower() for word in WORD.findall(name)]
