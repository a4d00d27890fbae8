"""docs/baselines.md: what nets owe to parts like those they are asked about, from its sweep."""

from collections.abc import Sequence
from pathlib import Path

from industnerf.errors import BadArtifact
from industnerf.report.formats import csv_rows, markdown
from industnerf.report.readme import table1_texts

Cells = dict[str, str]
HELD = {"family": "families held out", "part": "families seen", "none": "parts seen"}
SAME = 1e-5  # the last digit of sweep.csv: so near, the study has measured the same


def leakage_block(sweep: Path, study: Path) -> str:
    """A row a method, the floor first; what the published study has measured too, as it says it.

    Raises BadArtifact as `measured` does.
    """
    found = measured(sweep)
    rows = list(found.values())
    said = _said(study, found)
    heads = [head for held in HELD.values() for head in (held, "x floor")]
    heads.insert(1, "mm")
    floors = [cell for held in HELD for cell in (_floor(rows, held), "1")]
    lines = [["floor", floors[0], "", *floors[1:]]]
    for method in dict.fromkeys(row["method"] for row in rows):
        first, ratio, *others = [cell for held in HELD for cell in _cells(found[method, held])]
        lines.append([f"`{method}`", first, *said.get(method, ("", ratio)), *others])
    return markdown(["method", *heads], lines)


def measured(sweep: Path) -> dict[tuple[str, str], Cells]:
    """The rows of the test parts by method and what was held out.

    Raises BadArtifact if a method was not measured at every point.
    """
    rows = [row for row in csv_rows(sweep / "sweep.csv") if row["split"] == "test"]
    found = {(row["method"], row["split.hold_out"]): row for row in rows}
    for method, _ in found:
        for held in HELD:
            if (method, held) not in found:
                raise BadArtifact(
                    f"{sweep / 'sweep.csv'} has no {method} at split.hold_out {held}: bring in a "
                    "sweep with the same methods at every point, or leave the one before"
                )
    return found


def _cells(row: Cells) -> tuple[str, str]:
    emd, low, high = (float(row[name]) for name in ("emd", "low", "high"))
    return f"{emd:.4f} ({low:.4f} to {high:.4f})", f"{float(row['x floor']):.2f}"


def _floor(rows: Sequence[Cells], held: str) -> str:
    """Of the truth alone: the same for every method."""
    ratios = [float(r["emd"]) / float(r["x floor"]) for r in rows if r["split.hold_out"] == held]
    return f"{sum(ratios) / len(ratios):.4f}"


def _said(study: Path, found: dict[tuple[str, str], Cells]) -> dict[str, tuple[str, str]]:
    """The mm and x floor of each method whose EMD the study and the sweep agree on."""
    texts = table1_texts(study)
    return {
        row["method"]: (texts[row["method"]]["EMD, mm"], texts[row["method"]]["x floor"])
        for row in csv_rows(study / "table1.csv")
        if row["split"] == "test"
        and (one := found.get((row["method"], "family")))
        and abs(float(row["emd_even"]) - float(one["emd"])) < SAME
    }
