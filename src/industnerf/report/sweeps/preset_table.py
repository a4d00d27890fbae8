"""The table of docs/reference/sweeps.md: every sweep preset, its question and its result.

Below it are the presets whose results are in other documents.
"""

import json
import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from industnerf.config import flatten, read_yaml
from industnerf.report.publish.provenance import read_provenance
from industnerf.report.tables.formats import format_significant, markdown_table, read_csv

PRESETS, PUBLISHED = Path("conf/experiment"), Path("docs/reference/sweeps")
HEADERS = ("sweep", "question", "points", "time", "result", "cost exponents")
TABLES = (("table", "sweep.csv"), ("steps", "steps.csv"), ("trend", "trend.csv"))
SEED_RESULTS = Path("results/seeds")
RESULT_LINKS = {
    "ablation": "[method.md](method.md)",
    "readings": "[readings.md](readings.md)",
    "seeds": "[protocol.md](protocol.md)",
    "seeds_nets": "[protocol.md](protocol.md)",
}
# all others: pipeline.sweep_docs
PUBLISHED_BY = {
    "ablation": "ablation_effects",
    "readings": "ablation_effects",
    "seeds": "seed_variance",
    "seeds_nets": "seed_variance",
}
COMMAND = "python -m pipeline.sweep --multirun"
HYDRA_KEYS = ("defaults", "hydra")
INFLATED_SECONDS = "seconds are inflated"  # in the notes on a machine that was not idle
QUANTITIES = {"seconds": "seconds", "peak_mb": "MB"}


@dataclass(frozen=True)
class Preset:
    """A preset as its first comments describe it: the question, and the estimated time."""

    name: str
    question: str
    time: str


def sweep_presets(root: Path) -> list[Preset]:
    """The sweep presets below `root`, by name, and the preset leakage."""
    paths = [*(root / PRESETS).glob("leakage.yaml"), *(root / PRESETS).glob("sweep-*.yaml")]
    return [_preset(path) for path in sorted(paths)]


def _preset(path: Path) -> Preset:
    """Parse the comments: the package, the question, the time."""
    _, question, time = (
        line.lstrip("# ") for line in path.read_text(encoding="utf-8").splitlines()[:3]
    )
    return Preset(path.stem, question, time.rstrip("."))


def sweep_table(root: Path) -> str:
    """Markdown: a row per preset, its command in full, the plot of each that was run."""
    listed = sweep_presets(root)
    table = markdown_table(HEADERS, [_row(root, preset) for preset in listed])
    figures = [_figure(root, preset) for preset in listed if _is_published(root, preset)]
    commands = _command_lines(root, [preset.name for preset in listed])
    other_sweeps = f"{_other_sweeps(root)}{''.join(figures)}"
    return f"{table}\nThe same in full, a line each:\n\n{commands}{other_sweeps}"


def _command_lines(root: Path, names: list[str]) -> str:
    lines = [command_line_of(root / PRESETS / f"{name}.yaml") for name in names]
    return "".join(f"    {line}\n" for line in lines)


def _other_sweeps(root: Path) -> str:
    """Sweeps without a row: where their results are, and their commands."""
    names = multirun_presets(root) - {preset.name for preset in sweep_presets(root)}
    if not names:
        return ""
    locations = ", ".join(f"`{name}` {_result_location(root, name)}" for name in sorted(names))
    commands = _command_lines(root, sorted(names))
    return f"\nOther sweeps, and where their results stand: {locations}.\n\n{commands}"


def publishing_module(name: str) -> str:
    """The module that publishes a sweep of the preset `name`."""
    return f"pipeline.{PUBLISHED_BY.get(name, 'sweep_docs')}"


def multirun_presets(root: Path) -> set[str]:
    """All presets that Hydra is to run at several points."""
    modes = {
        path.stem: read_yaml(path).get("hydra", {}).get("mode")
        for path in (root / PRESETS).glob("*.yaml")
    }
    return {name for name, mode in modes.items() if mode == "MULTIRUN"}


def _result_location(root: Path, name: str) -> str:
    """Where the result of a sweep is, or that it was not run."""
    seeds = (
        read_provenance(root / SEED_RESULTS)["sweeps"]
        if (root / SEED_RESULTS / "made.json").exists()
        else ()
    )
    is_published = name in seeds or (root / f"docs/reference/{name}.csv").exists()
    return f"in {RESULT_LINKS[name]}" if is_published else "not yet run"


def _row(root: Path, preset: Preset) -> list[str]:
    name = f"`{preset.name}`"
    if not _is_published(root, preset):
        return [name, preset.question, "", f"{preset.time.lower()}, estimated", "not yet run", ""]
    folder = root / PUBLISHED / preset.name
    rows = read_csv(folder / "sweep.csv")
    points = len({row["point"] for row in rows})
    tables = [
        f"[{text}](sweeps/{preset.name}/{file})"
        for text, file in TABLES
        if _read_if_exists(folder / file)
    ]
    result = f"{_first_and_last_emd(rows)} ({', '.join(tables)})"
    metadata = _read_metadata(folder)
    time = f"{metadata['core_minutes']} minutes of one core, measured"
    return [name, preset.question, str(points), time, result, _cost_exponents(folder)]


def _first_and_last_emd(rows: list[dict[str, str]]) -> str:
    """EMD at the first and at the last point, of each method and split."""
    swept, texts = list(rows[0])[1], []
    has_several_splits = len({row["split"] for row in rows}) > 1
    for method, split in dict.fromkeys((row["method"], row["split"]) for row in rows):
        method_rows = [row for row in rows if (row["method"], row["split"]) == (method, split)]
        first, last = (_format_emd(row) for row in (method_rows[0], method_rows[-1]))
        texts.append(f"`{method}`{f' ({split})' if has_several_splits else ''} {first} to {last}")
    return f"EMD at `{swept}` {rows[0][swept]} and {rows[-1][swept]}: {', '.join(texts)}"


def _format_emd(row: dict[str, str]) -> str:
    """Such as `0.0179 (2.47 mm)`; older sweeps have no mm."""
    mm = f" ({format_significant(float(row['emd_mm']))} mm)" if row.get("emd_mm") else ""
    return f"{float(row['emd']):.4f}{mm}"


def _cost_exponents(folder: Path) -> str:
    """Exponents with standard errors, such as `hull` seconds 0.86 ± 0.18, MB 0.20 ± 0.04."""
    by_series: dict[str, list[str]] = {}
    for (label, quantity), (exponent, error) in published_exponents(folder).items():
        text = f"{QUANTITIES[quantity]} {exponent:z.2f} ± {error:.2f}"
        by_series.setdefault(label, []).append(text)
    return "; ".join(f"`{label}` {', '.join(texts)}" for label, texts in by_series.items())


def published_exponents(folder: Path) -> dict[tuple[str, str], tuple[float, float]]:
    """Series and quantity -> exponent and standard error, of the sweep published in `folder`.

    Those of seconds only if the machine was idle.
    """
    is_inflated = INFLATED_SECONDS in _read_metadata(folder)["machine"]
    return {
        (row["series"], row["quantity"]): (float(row["exponent"]), float(row["standard error"]))
        for row in _read_if_exists(folder / "trend.csv")
        if not (is_inflated and row["quantity"] == "seconds")
    }


def _read_if_exists(path: Path) -> list[dict[str, str]]:
    """The rows of a table; older sweeps lack some."""
    return read_csv(path) if path.exists() else []


def _figure(root: Path, preset: Preset) -> str:
    metadata = _read_metadata(root / PUBLISHED / preset.name)
    return (
        f"\n![{preset.name}](sweeps/{preset.name}/sweep.png)\n\n"
        f"`{preset.name}`, {metadata['date']}, at commit {metadata['commit']}, "
        f"{metadata['machine']}.\n"
    )


def _read_metadata(folder: Path) -> dict[str, Any]:
    return json.loads((folder / "about.json").read_text(encoding="utf-8"))


def _is_published(root: Path, preset: Preset) -> bool:
    return (root / PUBLISHED / preset.name / "about.json").exists()


def command_line_of(path: Path) -> str:
    """The command that the preset at `path` stands for: its base, what it sets, what it sweeps.

    Overrides of a command win over those of files. Where swept files set the same keys as the
    preset, the command has to name the preset.
    """
    preset = read_yaml(path)
    base = [f"experiment={name}" for name in preset.get("defaults", []) if name != "_self_"]
    overrides = {key: value for key, value in preset.items() if key not in HYDRA_KEYS}
    swept = preset["hydra"]["sweeper"]["params"]
    if any(set(read_yaml(file)) & set(overrides) for file in _group_files(path.parents[1], swept)):
        return f"{COMMAND} experiment={path.stem}"
    folder = {"hydra": {"sweep": preset["hydra"].get("sweep", {})}}
    values = flatten(overrides) | flatten(folder) | swept
    arguments = [*base, *(f"{key}={_hydra_text(value)}" for key, value in values.items())]
    return " ".join([COMMAND, *map(shlex.quote, arguments)])


def _group_files(conf: Path, swept: dict[str, Any]) -> list[Path]:
    """The files of the configuration groups that are swept."""
    return [file for key in swept for file in sorted((conf / key).glob("*.yaml"))]


def _hydra_text(value: Any) -> str:
    """`value` as Hydra reads it from a command line."""
    return f"[{','.join(map(str, value))}]" if isinstance(value, list) else str(value)
