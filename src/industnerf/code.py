"""Which code a result depends on: the import closure of the module that made it."""

import ast
import hashlib
from functools import cache
from importlib.util import find_spec
from pathlib import Path

PACKAGE = "industnerf"
# Types and words: they cannot change a result whose parameters are part of its key anyway.
WITHOUT_EFFECT = (f"{PACKAGE}.schema", f"{PACKAGE}.errors")


@cache
def source_of(module: str) -> Path | None:
    """The file of `module`, or None if there is no such module."""
    try:
        spec = find_spec(module)
    except ModuleNotFoundError:  # its parent is a module, not a package
        return None
    return Path(spec.origin) if spec and spec.origin else None


def _tree(module: str) -> ast.Module:
    """The syntax tree of `module`; empty if there is no such module."""
    source = source_of(module)
    return ast.parse(source.read_text(encoding="utf-8")) if source else ast.Module([], [])


@cache
def imports_of(module: str) -> frozenset[str]:
    """Modules of the suite that `module` names in an import statement, late imports included."""
    found = set()
    for node in ast.walk(_tree(module)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            below = {f"{node.module}.{alias.name}" for alias in node.names}
            submodules = {name for name in below if name.startswith(PACKAGE) and source_of(name)}
            # `from package import module` depends on the module; else on where the name lives
            found |= submodules if len(submodules) == len(below) else submodules | {node.module}
    return frozenset(name for name in found if name.partition(".")[0] == PACKAGE)


@cache
def closure(module: str) -> frozenset[str]:
    """`module` and all that it imports from the suite, directly or not."""
    seen: set[str] = set()
    todo = [module]
    while todo:
        name = todo.pop()
        if name not in seen and not name.startswith(WITHOUT_EFFECT):
            seen.add(name)
            todo += imports_of(name)
    return frozenset(seen)


@cache
def code_digest(module: str) -> str:
    """A digest of the closure's syntax trees: comments, layout and docstrings do not count."""
    parts = [
        f"{name}\n{ast.dump(_without_docstrings(_tree(name)))}" for name in sorted(closure(module))
    ]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def _without_docstrings(tree: ast.Module) -> ast.Module:
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(
            node, clean=False
        ):
            node.body = node.body[1:]
    return tree
