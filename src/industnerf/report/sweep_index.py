"""The table of docs/sweeps.md: every sweep preset, what it asks, and what came out.

Below it are the presets whose results have documents of their own.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from industnerf.config import read_yaml
from industnerf.report.formats import brief, csv_rows
from industnerf.report.provenance import read_made
from industnerf.report.sweep_lines import line_of

PRESETS, PUBLISHED = Path("conf/experiment"), Path("docs/sweeps")
HEAD = ("sweep", "question", "points", "time", "result", "cost exponents")
TABLES = (("table", "sweep.csv"), ("steps", "steps.csv"), ("trend", "trend.csv"))
SEEDS = Path("results/seeds")
ELSEWHERE = {
    "ablation": "[method.md](method.md)",
    "readings": "[readings.md](readings.md)",
    "seeds": f"[{SEEDS}](../{SEEDS}/seeds.md)",
    "seeds_nets": f"[{SEEDS}](../{SEEDS}/seeds.md)",
}
# all others are brought by pipeline.sweeps
BROUGHT_BY = {
    "ablation": "effects",
    "readings": "effects",
    "seeds": "spread",
    "seeds_nets": "spread",
}
INFLATED = "seconds are inflated"  # is said of a machine that was shared with other work
QUANTITIES = {"seconds": "seconds", "peak_mb": "MB"}


@dataclass(frozen=True)
class Preset:
    """A preset as its first comments describe it: what it asks, and how long it may take."""

    name: str
    question: str
    time: str


def presets(root: Path) -> list[Preset]:
    """The sweep presets below `root`, by name; `leakage` is one."""
    paths = [*(root / PRESETS).glob("leakage.yaml"), *(root / PRESETS).glob("sweep-*.yaml")]
    return [_preset(path) for path in sorted(paths)]


def _preset(path: Path) -> Preset:
    """Comments: the package, the question, the time."""
    _, question, time = (
        line.lstrip("# ") for line in path.read_text(encoding="utf-8").splitlines()[:3]
    )
    return Preset(path.stem, question, time.rstrip("."))


def index(root: Path) -> str:
    """Markdown: a row a preset, the line that each stands for, the plot of each that was run."""
    found = presets(root)
    rows = [list(HEAD), ["---"] * len(HEAD)] + [_row(root, preset) for preset in found]
    table = "".join(f"| {' | '.join(row)} |\n" for row in rows)
    plates = [_plate(root, preset) for preset in found if _published(root, preset)]
    lines = _lines(root, [preset.name for preset in found])
    return f"{table}\nThe same in full, a line each:\n\n{lines}{_others(root)}{''.join(plates)}"


def _lines(root: Path, names: list[str]) -> str:
    lines = [line_of(root / PRESETS / f"{name}.yaml") for name in names]
    return "".join(f"    {line}\n" for line in lines)


def _others(root: Path) -> str:
    """The presets that sweep and have no row: where their results stand, and their lines."""
    names = sweeping(root) - {preset.name for preset in presets(root)}
    if not names:
        return ""
    where = ", ".join(f"`{name}` {_where(root, name)}" for name in sorted(names))
    lines = _lines(root, sorted(names))
    return f"\nOther sweeps, and where their results stand: {where}.\n\n{lines}"


def brought_by(name: str) -> str:
    """The module that publishes a sweep of the preset `name`."""
    return f"pipeline.{BROUGHT_BY.get(name, 'sweeps')}"


def sweeping(root: Path) -> set[str]:
    """All presets that Hydra is to run at several points."""
    modes = {
        path.stem: read_yaml(path).get("hydra", {}).get("mode")
        for path in (root / PRESETS).glob("*.yaml")
    }
    return {name for name, mode in modes.items() if mode == "MULTIRUN"}


def _where(root: Path, name: str) -> str:
    """`pipeline.effects` leaves a table of the points, `pipeline.spread` says what it read."""
    seeds = read_made(root / SEEDS)["sweeps"] if (root / SEEDS / "made.json").exists() else ()
    known = name in seeds or (root / f"docs/{name}.csv").exists()
    return f"in {ELSEWHERE[name]}" if known else "not yet run"


def _row(root: Path, preset: Preset) -> list[str]:
    name = f"`{preset.name}`"
    if not _published(root, preset):
        return [name, preset.question, "", f"{preset.time.lower()}, estimated", "not yet run", ""]
    folder = root / PUBLISHED / preset.name
    lines = csv_rows(folder / "sweep.csv")
    points = len({line["point"] for line in lines})
    tables = [
        f"[{text}](sweeps/{preset.name}/{file})" for text, file in TABLES if _rows(folder / file)
    ]
    result = f"{_ends(lines)} ({', '.join(tables)})"
    about = _about(root, preset)
    time = f"{about['core_minutes']} minutes of one core, measured"
    growth = _growth(folder, INFLATED not in about["machine"])
    return [name, preset.question, str(points), time, result, growth]


def _ends(lines: list[dict[str, str]]) -> str:
    """EMD at the first and at the last point, of each method and split."""
    swept, texts = list(lines[0])[1], []
    several = len({line["split"] for line in lines}) > 1
    for method, split in dict.fromkeys((line["method"], line["split"]) for line in lines):
        mine = [line for line in lines if (line["method"], line["split"]) == (method, split)]
        first, last = (_emd(line) for line in (mine[0], mine[-1]))
        texts.append(f"`{method}`{f' ({split})' if several else ''} {first} to {last}")
    return f"EMD at `{swept}` {lines[0][swept]} and {lines[-1][swept]}: {', '.join(texts)}"


def _emd(line: dict[str, str]) -> str:
    """Such as `0.0179 (2.47 mm)`; sweeps of before have no mm."""
    mm = f" ({brief(float(line['emd_mm']))} mm)" if line.get("emd_mm") else ""
    return f"{float(line['emd']):.4f}{mm}"


def _growth(folder: Path, timed: bool) -> str:
    """Such as `hull` seconds 0.86 ± 0.18, MB 0.20 ± 0.04: exponents with their standard errors.

    Those of seconds only where they were `timed` with nothing beside.
    """
    found: dict[str, list[str]] = {}
    for row in _rows(folder / "trend.csv"):
        if row["quantity"] == "seconds" and not timed:
            continue
        exponent, error = (float(row[name]) for name in ("exponent", "standard error"))
        text = f"{QUANTITIES[row['quantity']]} {exponent:z.2f} ± {error:.2f}"
        found.setdefault(row["series"], []).append(text)
    return "; ".join(f"`{label}` {', '.join(texts)}" for label, texts in found.items())


def _rows(path: Path) -> list[dict[str, str]]:
    """Nothing where there is no such table; sweeps of before had fewer."""
    return csv_rows(path) if path.exists() else []


def _plate(root: Path, preset: Preset) -> str:
    about = _about(root, preset)
    return (
        f"\n![{preset.name}](sweeps/{preset.name}/sweep.png)\n\n"
        f"`{preset.name}`, {about['date']}, at commit {about['commit']}, {about['machine']}.\n"
    )


def _about(root: Path, preset: Preset) -> dict[str, Any]:
    return json.loads((root / PUBLISHED / preset.name / "about.json").read_text(encoding="utf-8"))


def _published(root: Path, preset: Preset) -> bool:
    return (root / PUBLISHED / preset.name / "about.json").exists()
