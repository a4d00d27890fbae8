"""The document: a table a section, and one a method; the NeRFs share theirs."""

from dataclasses import dataclass
from typing import Any

from industnerf.report.hyperparameters.allowed import allowed
from industnerf.report.hyperparameters.comments import comments, meaning
from industnerf.report.hyperparameters.readers import readers
from industnerf.report.hyperparameters.symbols import NERFS, PAPER
from industnerf.report.leaves import leaves

HEAD = """# Hyper-parameters

Section 4.2 of the paper promises "a list of the hyperparameters and other pertinent training
details"; none follows. This is ours: every value of `params.yaml` with its comment there, what it
may be, what the paper calls it, and the stages of `dvc.yaml` that read it: they rerun when it
changes.

This file is generated: `python -m industnerf.report.hyperparameters` writes it.
"""


@dataclass(frozen=True)
class Sources:
    """What the document is made of."""

    values: dict[str, Any]  # dotted key -> value of params.yaml
    said: dict[str, str]  # dotted key -> its comment there, of sections too
    stages: dict[str, dict[str, Any]]  # of dvc.yaml


def document(text: str, values: dict[str, Any], stages: dict[str, dict[str, Any]]) -> str:
    """All parameters as Markdown; `text` is params.yaml, and `values` what it holds."""
    sources = Sources(leaves(values), comments(text), stages)
    sections = [name for name, value in values.items() if isinstance(value, dict)]
    sections.remove("method")
    methods = [f"method.{name}" for name in values["method"] if name not in NERFS]
    single = [key for key in sources.values if "." not in key]
    return "".join(
        [
            f"{HEAD}\n## The study\n\n{_table(sources, '', {'': single})}",
            *(_section(sources, name) for name in sections),
            _nerfs(sources),
            *(_section(sources, name) for name in methods),
        ]
    )


def _section(sources: Sources, prefix: str) -> str:
    keys = {"": _below(sources, prefix)}
    return _titled(sources, prefix) + _table(sources, f"{prefix}.", keys)


def _nerfs(sources: Sources) -> str:
    about = "".join(f"- `{name}`: {sources.said[f'method.{name}']}\n" for name in NERFS)
    keys = {f"method.{name}.": _below(sources, f"method.{name}") for name in NERFS}
    title = f"\n## `method.{'`, `method.'.join(NERFS)}`\n\nOne code, five settings.\n\n{about}\n"
    return title + _table(sources, "", keys)


def _below(sources: Sources, prefix: str) -> list[str]:
    return [key for key in sources.values if key.startswith(f"{prefix}.")]


def _titled(sources: Sources, prefix: str) -> str:
    about = sources.said.get(prefix, "")
    stop = "" if about.endswith("?") else "."
    text = f"{about[0].upper()}{about[1:]}{stop}\n\n" if about else ""
    return f"\n## `{prefix}`\n\n{text}"


def _table(sources: Sources, cut: str, columns: dict[str, list[str]]) -> str:
    """A row for every key, without `cut`; a column of values for every prefix in `columns`."""
    names = [prefix.removeprefix("method.").strip(".") or "value" for prefix in columns]
    rows = [["name", *names, "allowed", "paper", "meaning", "read by"]]
    rows.append(["---"] * len(rows[0]))
    short = dict.fromkeys(key.removeprefix(p) for p, keys in columns.items() for key in keys)
    section = cut
    for name in short:
        above = name.rpartition(".")[0]
        if above != section and not cut.startswith(f"{above}."):
            about = meaning(f"{next(iter(columns))}{above}", sources.said)
            rows += [_line(f"**{above.removeprefix(cut)}**", names, about)] if about else []
        section = above
        rows.append(_row(sources, cut, list(columns), name))
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


def _line(title: str, names: list[str], about: str) -> list[str]:
    """What a section within a table is about."""
    return [title, *[""] * (len(names) + 2), escaped(about), ""]


def _row(sources: Sources, cut: str, prefixes: list[str], name: str) -> list[str]:
    keys = [f"{prefix}{name}" for prefix in prefixes]
    known = next(key for key in keys if key in sources.values)
    return [
        f"`{name.removeprefix(cut)}`",
        *(shown(sources.values[key]) if key in sources.values else "" for key in keys),
        escaped(allowed(known)),
        PAPER.get(known, ""),
        escaped(meaning(known, sources.said)),
        ", ".join(readers(known, sources.stages)),
    ]


def shown(value: Any) -> str:
    """A value as params.yaml would have it, but always in one line."""
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, float):
        return f"`{value:g}`"
    if isinstance(value, list):
        return f"`[{', '.join(shown(each).strip('`') for each in value)}]`"
    return f"`{value}`"


def escaped(text: str) -> str:
    """`text` in a cell of a table."""
    return text.replace("|", "\\|").replace("*", "\\*")
