"""What each addition of `industnerf_plus` earns: from a sweep to docs/method.md."""

import re
from statistics import fmean
from typing import Any

from industnerf.errors import BadArtifact
from industnerf.report.effects import Outcome, difference
from industnerf.report.formats import intervals_of, markdown
from industnerf.schema import ReportParams

METHODS = ("industnerf_plus",)
HEADS = [
    "changed",
    "EMD even",
    "more than with all",
    "95 %",
    "worse on",
    "failed",
    "RGB MSE",
    "RGB worse on",
]


def table(found: list[Outcome], usual: dict[str, Any], ways: ReportParams) -> str:
    """A row for every point of the sweep, by how much worse it is than with all additions.

    `usual` are the settings with all of them, by dotted key.  Raises BadArtifact if no point has
    just these: there is nothing to compare with.

    RGB MSE is of the parts that did not fail: of the others there are no pictures.
    """
    by_change = {changed(one.settings, usual): one for one in found}
    base = by_change.pop("", None)
    if base is None:
        raise BadArtifact(
            "no finished point has the settings of params.yaml; were they changed after the sweep?"
        )
    nothing = ["nothing", _mean(base.emd, 4), "", "", "", str(base.failed), _mean(base.rgb_mse, 5)]
    rows = [[*nothing, ""]]
    worst = sorted(by_change.items(), key=lambda item: -fmean(item[1].emd.values()))
    rows += [_row(name, one, base, ways) for name, one in worst]
    return markdown(intervals_of(HEADS, ways.interval), rows)


def changed(settings: dict[str, Any], usual: dict[str, Any]) -> str:
    """What is not as usual, as Markdown; empty if all is."""
    values = [f"`{k}: {v}`" for k, v in settings.items() if k not in usual or v != usual[k]]
    gone = [re.sub(r"\].*", "]", key) for key in usual if key not in settings]
    return ", ".join([*values, *(f"no `{key}`" for key in dict.fromkeys(gone))])


def _row(name: str, one: Outcome, base: Outcome, ways: ReportParams) -> list[str]:
    return [
        name,
        _mean(one.emd, 4),
        *difference(one, base, ways),
        _worse(one.emd, base.emd),
        str(one.failed),
        _mean(one.rgb_mse, 5),
        _worse(one.rgb_mse, base.rgb_mse),
    ]


def _mean(values: dict[str, float], digits: int) -> str:
    return f"{fmean(values.values()):.{digits}f}" if values else ""


def _worse(values: dict[str, float], base: dict[str, float]) -> str:
    parts = values.keys() & base.keys()
    return f"{sum(values[part] > base[part] for part in parts)} of {len(parts)}" if parts else ""
