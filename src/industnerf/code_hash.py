"""Which code a result depends on: the import closure of the module that made it, and libraries."""

import ast
import hashlib
import sys
from collections.abc import Mapping
from functools import cache
from importlib.metadata import packages_distributions, version
from importlib.util import find_spec
from pathlib import Path

PACKAGE = "industnerf"
# Types and words: they cannot change a result whose parameters are part of its key anyway.
IGNORED_PACKAGES = (f"{PACKAGE}.schema", f"{PACKAGE}.errors")
IGNORED_LIBRARIES = {"jaxtyping"}  # types too


@cache
def source_path(module: str) -> Path | None:
    """The file of `module`, or None if there is no such module."""
    try:
        spec = find_spec(module)
    except ModuleNotFoundError:  # its parent is a module, not a package
        return None
    return Path(spec.origin) if spec and spec.origin else None


def _syntax_tree(module: str) -> ast.Module:
    """The syntax tree of `module`; empty if there is no such module."""
    source = source_path(module)
    return ast.parse(source.read_text(encoding="utf-8")) if source else ast.Module([], [])


@cache
def _imports(module: str) -> frozenset[str]:
    """What `module` names in an import statement, late imports included; all names are absolute."""
    modules = set()
    for node in ast.walk(_syntax_tree(module)):
        if isinstance(node, ast.Import):
            modules |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            candidates = {f"{node.module}.{alias.name}" for alias in node.names}
            submodules = {
                name for name in candidates if name.startswith(PACKAGE) and source_path(name)
            }
            # `from package import module` depends on the module; else on where the name lives
            modules |= (
                submodules if len(submodules) == len(candidates) else submodules | {node.module}
            )
    return frozenset(modules)


def imported_modules(module: str) -> frozenset[str]:
    """Modules of the suite that `module` imports."""
    return frozenset(name for name in _imports(module) if name.partition(".")[0] == PACKAGE)


@cache
def import_closure(module: str) -> frozenset[str]:
    """`module` and all that it imports from the suite, directly or not."""
    seen: set[str] = set()
    todo = [module]
    while todo:
        name = todo.pop()
        if name not in seen and not name.startswith(IGNORED_PACKAGES):
            seen.add(name)
            todo += imported_modules(name)
    return frozenset(seen)


@cache
def code_digest(module: str) -> str:
    """A digest of the closure's syntax trees: comments, layout and docstrings do not count."""
    dumps = [
        f"{name}\n{ast.dump(_without_docstrings(_syntax_tree(name)))}"
        for name in sorted(import_closure(module))
    ]
    return hashlib.sha256("\n".join(dumps).encode()).hexdigest()


@cache
def library_versions(modules: tuple[str, ...]) -> Mapping[str, str]:
    """Installed versions of the libraries that the closures of `modules` import.

    Of libraries by which those work only the ones are listed that the suite itself imports too.
    """
    closure = frozenset[str]().union(*map(import_closure, modules))
    names = {name.partition(".")[0] for module in closure for name in _imports(module)}
    names -= {PACKAGE, *IGNORED_LIBRARIES, *sys.stdlib_module_names}
    return {
        distribution: version(distribution)
        for name in sorted(names)
        for distribution in _distributions().get(name, [])[:1]
    }


@cache
def _distributions() -> dict[str, list[str]]:
    """What is installed: name that is imported -> names under which it is installed."""
    return dict(packages_distributions())


def _without_docstrings(tree: ast.Module) -> ast.Module:
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(
            node, clean=False
        ):
            node.body = node.body[1:]
    return tree
