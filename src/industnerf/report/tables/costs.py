"""What each result cost, from the store's side-cars; unknown where the store is not at hand.

The split, a fraction of a second, is in no store and is not counted; the report counts itself.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

from industnerf.artifacts.files import write_text
from industnerf.report.study import StudyFolders
from industnerf.report.tables.formats import csv_text
from industnerf.stage import read_index
from industnerf.store import Cost, Store


@dataclass(frozen=True)
class CostRow:
    """Cost of one part in one stage; `method` is empty in stages that are not per method."""

    stage: str
    method: str
    part_id: str
    cost: Cost


def read_costs(folders: StudyFolders, methods: list[str]) -> list[CostRow]:
    """All costs that the store still knows."""
    stages = {name: getattr(folders, name) for name in ("solids", "parts", "views", "truth")}
    rows = [row for name, folder in stages.items() for row in _rows(name, "", folder)]
    for method in methods:
        rows += _rows("train", method, folders.states / method)
        rows += _rows("reconstruct", method, folders.clouds / method)
        rows += _rows("evaluate", method, folders.scores / method)
    return rows


def _rows(stage: str, method: str, folder: Path) -> Iterator[CostRow]:
    store = Store.from_environment()
    for part_id, key in read_index(folder).items():
        cost = store.cost(stage, key)
        if cost:
            yield CostRow(stage, method, part_id, cost)


def costs_csv(rows: list[CostRow]) -> str:
    """`cost.csv`: stage,method,part_id,seconds,peak_mb,device,extra_seconds."""
    return csv_text(
        ["stage", "method", "part_id", *Cost.__dataclass_fields__], map(_row_cells, rows)
    )


def add_cost(path: Path, row: CostRow) -> None:
    """Append `row` to the cost.csv at `table`: what the report cost is known when it is written."""
    write_text(path, path.read_text(encoding="utf-8") + csv_text(_row_cells(row), []))


def _row_cells(row: CostRow) -> list[str]:
    return [row.stage, row.method, row.part_id, *map(str, vars(row.cost).values())]


def seconds_per_part(rows: Sequence[CostRow], method: str, parts: Collection[str]) -> float | None:
    """Mean seconds that `method` takes for one of `parts`; None if the store knows none."""
    seconds = [
        row.cost.seconds
        for row in rows
        if (row.stage, row.method) == ("reconstruct", method) and row.part_id in parts
    ]
    return fmean(seconds) if seconds else None
