"""What each reading of the paper costs or gains by itself: from a sweep to docs/readings.md."""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from statistics import fmean
from typing import Any, get_args, get_type_hints

from industnerf.config import read_yaml
from industnerf.errors import BadArtifact
from industnerf.report.formats import csv_rows, intervals_of, markdown
from industnerf.report.leaves import leaves
from industnerf.report.lookup import EVEN
from industnerf.report.statistics import SEED, paired_change
from industnerf.schema import ReportParams
from industnerf.schema.readings import Readings

METHODS = ("industnerf", "industnerf_shared")  # the second is reading `shared` of R14
HEADS = ["id", "reading", "EMD even", "less the default's", "95 %", "parts", "failed"]
UNKNOWN = "not yet measured"
RGB = ("rgb_mse", "P1-union")


@dataclass(frozen=True)
class Outcome:
    """What the method scored under one set of settings."""

    settings: dict[str, Any]  # by dotted key
    emd: dict[str, float]  # part id -> EMD (even)
    families: dict[str, str]
    failed: int
    rgb_mse: dict[str, float] = field(default_factory=dict)  # part id -> RGB MSE


def outcomes(sweep: Path, methods: Sequence[str] = METHODS) -> list[Outcome]:
    """Every finished point of the folder of a sweep, of the first of `methods` that it ran.

    Raises BadArtifact if there is none.
    """
    points = [path.parent.parent for path in sorted(sweep.glob("*/reports/scores.csv"))]
    if not points:
        raise BadArtifact(f"{sweep} holds no finished point; the same sweep goes on")
    return [_outcome(point, methods) for point in points]


def _outcome(point: Path, methods: Sequence[str]) -> Outcome:
    params = read_yaml(point / "params.yaml")
    method = next((name for name in methods if name in params["methods"]), None)
    if method is None:
        raise BadArtifact(f"{point} ran none of {', '.join(methods)}")
    of_method = [
        row for row in csv_rows(point / "reports" / "scores.csv") if row["method"] == method
    ]
    rows = [row for row in of_method if (row["metric"], row["protocol"]) == EVEN]
    seen = [row for row in of_method if (row["metric"], row["protocol"]) == RGB]
    return Outcome(
        leaves(params["method"][method]),
        {row["part_id"]: float(row["value"]) for row in rows},
        {row["part_id"]: row["family"] for row in rows},
        sum(row["status"] != "ok" for row in rows),
        {row["part_id"]: float(row["value"]) for row in seen},
    )


def table(found: list[Outcome], default: Readings, ids: dict[str, str], ways: ReportParams) -> str:
    """A row for every reading of every id: its mean, and the mean paired difference.

    `ids` maps the name of a reading to its number.  A point in which more than one reading is
    not the default says nothing about either, and is not used.
    """
    usual = vars(default)
    alone = {_only_change(one.settings, usual): one for one in found}
    base = alone.get(("", ""))
    rows = [
        _row(ids[name], value, value == usual[name], alone, base, name, ways)
        for name in (each.name for each in fields(Readings))
        for value in _ordered(name, usual[name])
    ]
    return markdown(intervals_of(HEADS, ways.interval), rows)


def _ordered(name: str, default: str) -> list[str]:
    values = get_args(get_type_hints(Readings)[name])
    return sorted(values, key=lambda value: value != default)


def _only_change(settings: dict[str, Any], usual: dict[str, str]) -> tuple[str, str] | None:
    """The one reading that is not as usual; two empty texts if all are, None if several are not.

    Raises BadArtifact if the sweep did not know one of them.
    """
    if missing := [name for name in usual if f"readings.{name}" not in settings]:
        raise BadArtifact(f"the sweep was run before {missing[0]} was a reading: run it anew")
    now = {name: settings[f"readings.{name}"] for name in usual}
    changed = [(name, value) for name, value in now.items() if value != usual[name]]
    return ("", "") if not changed else changed[0] if len(changed) == 1 else None


def _row(
    number: str,
    value: str,
    is_default: bool,
    alone: dict[tuple[str, str] | None, Outcome],
    base: Outcome | None,
    name: str,
    ways: ReportParams,
) -> list[str]:
    one = base if is_default else alone.get((name, value))
    if one is None:
        return [number, f"`{value}`", UNKNOWN, "", "", "", ""]
    cells = [number, f"`{value}`", f"{fmean(one.emd.values()):.4f}"]
    cells += ["", ""] if is_default or base is None else difference(one, base, ways)
    return [*cells, str(len(one.emd)), str(one.failed)]


def difference(one: Outcome, base: Outcome, ways: ReportParams) -> list[str]:
    """The mean over parts of what `one` scored less what `base` did, and its interval."""
    change = paired_change(base.emd, one.emd, base.families, ways, SEED)
    if change is None:
        return ["", ""]
    return [f"{change.mean:+.4f}", f"{change.low:+.4f} to {change.high:+.4f}"]
