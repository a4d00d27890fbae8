"""The document: a table a section, and one a method; the NeRFs share theirs."""

import json
from dataclasses import dataclass
from typing import Any

from industnerf.config import flatten
from industnerf.report.docs.hyperparameters.allowed_values import allowed_values
from industnerf.report.docs.hyperparameters.paper_symbols import NERF_METHODS, PAPER_SYMBOLS
from industnerf.report.docs.hyperparameters.yaml_comments import find_meaning, parse_comments

HEAD = """# Hyperparameters

Section 4.2 of the paper promises "a list of the hyperparameters and other pertinent training
details", and gives none. This list has every value of `params.yaml`. *Allowed* is the range or the
choices, and *paper* is the paper's symbol or section. *Read by* names the stages of `dvc.yaml` that
rerun when the value changes.

This page is generated. Write it again with

    python -m industnerf.report.docs
"""


@dataclass(frozen=True)
class DocumentInputs:
    """What the document is made of."""

    values: dict[str, Any]  # dotted key -> value of params.yaml
    comments: dict[str, str]  # dotted key -> its comment there, of sections too
    stages: dict[str, dict[str, Any]]  # of dvc.yaml


def render_document(text: str, values: dict[str, Any], stages: dict[str, dict[str, Any]]) -> str:
    """All parameters as Markdown; `text` is params.yaml, and `values` what it holds."""
    inputs = DocumentInputs(flatten(values, split_lists=True), parse_comments(text), stages)
    sections = [name for name, value in values.items() if isinstance(value, dict)]
    sections.remove("method")
    methods = [f"method.{name}" for name in values["method"] if name not in NERF_METHODS]
    top_level = [key for key in inputs.values if "." not in key]
    return "".join(
        [
            f"{HEAD}\n## The study\n\n{_table(inputs, '', {'': top_level})}",
            *(_section(inputs, name) for name in sections),
            _nerf_section(inputs),
            *(_section(inputs, name) for name in methods),
        ]
    )


def _section(inputs: DocumentInputs, prefix: str) -> str:
    keys = {"": _keys_below(inputs, prefix)}
    return _heading(inputs, prefix) + _table(inputs, f"{prefix}.", keys)


def _nerf_section(inputs: DocumentInputs) -> str:
    descriptions = "".join(
        f"- `{name}`: {inputs.comments[f'method.{name}']}\n" for name in NERF_METHODS
    )
    keys = {f"method.{name}.": _keys_below(inputs, f"method.{name}") for name in NERF_METHODS}
    title = ", ".join(f"`method.{name}`" for name in NERF_METHODS)
    text = f"\n## {title}\n\nOne implementation with five sets of values.\n\n{descriptions}\n"
    return text + _table(inputs, "", keys)


def _keys_below(inputs: DocumentInputs, prefix: str) -> list[str]:
    return [key for key in inputs.values if key.startswith(f"{prefix}.")]


def _heading(inputs: DocumentInputs, prefix: str) -> str:
    description = inputs.comments.get(prefix, "")
    period = "" if description.endswith("?") else "."
    text = f"{description[0].upper()}{description[1:]}{period}\n\n" if description else ""
    return f"\n## `{prefix}`\n\n{text}"


def _table(inputs: DocumentInputs, strip_prefix: str, columns: dict[str, list[str]]) -> str:
    """A row for every key, without `strip_prefix`; a column of values for each of `columns`."""
    names = [prefix.removeprefix("method.").strip(".") or "value" for prefix in columns]
    rows = [["name", *names, "allowed", "paper", "meaning", "read by"]]
    rows.append(["---"] * len(rows[0]))
    short_names = dict.fromkeys(key.removeprefix(p) for p, keys in columns.items() for key in keys)
    section = strip_prefix
    for name in short_names:
        parent = name.rpartition(".")[0]
        if parent != section and not strip_prefix.startswith(f"{parent}."):
            description = find_meaning(f"{next(iter(columns))}{parent}", inputs.comments)
            rows += (
                [_subsection_row(f"**{parent.removeprefix(strip_prefix)}**", names, description)]
                if description
                else []
            )
        section = parent
        rows.append(_row(inputs, strip_prefix, list(columns), name))
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


def _subsection_row(title: str, names: list[str], description: str) -> list[str]:
    """What a section within a table is about."""
    return [title, *[""] * (len(names) + 2), escape_cell(description), ""]


def _row(inputs: DocumentInputs, strip_prefix: str, prefixes: list[str], name: str) -> list[str]:
    keys = [f"{prefix}{name}" for prefix in prefixes]
    present_key = next(key for key in keys if key in inputs.values)
    return [
        f"`{name.removeprefix(strip_prefix)}`",
        *(format_value(inputs.values[key]) if key in inputs.values else "" for key in keys),
        escape_cell(allowed_values(present_key)),
        PAPER_SYMBOLS.get(present_key, ""),
        escape_cell(find_meaning(present_key, inputs.comments)),
        ", ".join(reader_stages(present_key, inputs.stages)),
    ]


def reader_stages(key: str, stages: dict[str, dict[str, Any]]) -> list[str]:
    """The stages that list `key` or a section above it, or have it in their wiring."""
    return [
        name
        for name, stage in stages.items()
        if _depends_on(key, stage) or _interpolates(key, stage)
    ]


def _depends_on(key: str, stage: dict[str, Any]) -> bool:
    listed = stage.get("params", [])
    return any(key == name or key.startswith((f"{name}.", f"{name}[")) for name in listed)


def _interpolates(key: str, stage: dict[str, Any]) -> bool:
    return f"${{{key}}}" in json.dumps(stage)


def format_value(value: Any) -> str:
    """A value as params.yaml would have it, but always in one line."""
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, float):
        return f"`{value:g}`"
    if isinstance(value, list):
        return f"`[{', '.join(format_value(item).strip('`') for item in value)}]`"
    return f"`{value}`"


def escape_cell(text: str) -> str:
    """`text` in a cell of a table."""
    return text.replace("|", "\\|").replace("*", "\\*")
