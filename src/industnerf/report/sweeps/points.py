"""The finished points of a sweep, read from their reports or from a published sweep.csv."""

import json
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import Any

from industnerf.config import flatten, read_yaml
from industnerf.errors import BadArtifact
from industnerf.report.tables.costs import csv_seconds
from industnerf.report.tables.formats import optional_float, read_csv
from industnerf.report.tables.scores import EMD_EVEN

SELECT_KEY = "parts.select"


@dataclass(frozen=True)
class PointResult:
    """One method at one point, over the parts of one split."""

    method: str
    split: str
    emd: float  # even, in bounding-box diagonals
    low: float | None  # of the interval of report.confidence_level; None: of one family
    high: float | None
    emd_mm: float | None  # None where a published table has no such column
    ratio_to_floor: float
    seconds: float | None  # mean of a reconstruction; None where unknown
    peak_mb: float | None
    num_parameters: int | None  # learned for a part, without pruned ones
    emd_by_part: dict[str, float]  # EMD (even)


@dataclass(frozen=True)
class SweepPoint:
    """One finished point of a sweep."""

    number: int
    params: dict[str, Any]  # by dotted key
    faces: float  # mean of its parts' meshes
    results: list[PointResult]
    families: dict[str, str]  # by part

    def axis_value(self, key: str) -> Any:
        """The value of `key`; for a sweep over parts their mean number of faces."""
        return self.faces if key == SELECT_KEY else self.params.get(key)


def read_points(sweep: Path) -> list[SweepPoint]:
    """The finished points in the folder of a sweep, by number."""
    return [_read_point(folder) for folder in _folders(sweep) if _is_finished(folder)]


def count_unfinished(sweep: Path) -> int:
    """The number of points that have no report: they failed."""
    return sum(not _is_finished(folder) for folder in _folders(sweep))


def preset_of(sweep: Path) -> str:
    """The preset that the sweep ran; raises BadArtifact unless every point of it is finished."""
    for name, when in (("made.json", "start"), ("sweep.csv", "end")):
        if not (sweep / name).exists():
            raise BadArtifact(f"{sweep / name} is missing; a sweep writes it at its {when}")
    if failed := count_unfinished(sweep):
        raise BadArtifact(f"{failed} points of {sweep} have no report; the same line goes on")
    first = next(sweep.glob("*/params.yaml"), None)
    if first is None:
        raise BadArtifact(f"{sweep} has no point; the same line makes them")
    return read_yaml(first)["preset"]


def _folders(sweep: Path) -> list[Path]:
    return sorted((p for p in sweep.iterdir() if p.name.isdigit()), key=lambda p: int(p.name))


def _is_finished(folder: Path) -> bool:
    return (folder / "reports/summary.json").exists()


def swept_keys(points: list[SweepPoint]) -> list[str]:
    """The parameters that differ between points, or `preset` where none does."""
    names = dict.fromkeys(key for point in points for key in point.params)
    keys = [key for key in names if len({str(point.params.get(key)) for point in points}) > 1]
    return keys or ["preset"]


def _read_point(folder: Path) -> SweepPoint:
    scores = read_csv(folder / "reports/scores.csv")
    seconds, peaks = _costs(folder / "reports", {row["part_id"]: row["split"] for row in scores})
    emds = _emds(scores)
    results = [
        PointResult(
            row["method"],
            row["split"],
            float(row["emd_even"]),
            *(optional_float(row[name]) for name in ("ci_low", "ci_high")),
            *(float(row[name]) for name in ("emd_mm", "ratio_to_floor")),
            seconds.get((row["method"], row["split"])),
            peaks.get((row["method"], row["split"])),
            int(row["parameters"]),
            emds[row["method"], row["split"]],
        )
        for row in read_csv(folder / "reports/table1.csv")
    ]
    families = {row["part_id"]: row["family"] for row in scores}
    parts = [
        json.loads(path.read_text(encoding="utf-8"))
        for path in folder.glob("data/parts/*/part.json")
    ]
    params = flatten(read_yaml(folder / "params.yaml"), split_lists=True)
    faces = fmean(part["faces"] for part in parts)
    return SweepPoint(int(folder.name), params, faces, results, families)


def _emds(scores: list[dict[str, str]]) -> dict[tuple[str, str], dict[str, float]]:
    """The EMD (even) of each part, by method and split."""
    emds: dict[tuple[str, str], dict[str, float]] = defaultdict(dict)
    for row in scores:
        if (row["metric"], row["protocol"]) == EMD_EVEN:
            emds[row["method"], row["split"]][row["part_id"]] = float(row["value"])
    return emds


def _costs(
    reports: Path, split_of: dict[str, str]
) -> tuple[dict[tuple[str, str], float], dict[tuple[str, str], float]]:
    """Mean processor seconds and mean peak MB of a reconstruction, by method and split."""
    seconds, peaks = defaultdict(list), defaultdict(list)
    for row in read_csv(reports / "cost.csv"):
        if row["stage"] == "reconstruct" and row["part_id"] in split_of:  # it may have no score
            method_split = row["method"], split_of[row["part_id"]]
            seconds[method_split].append(csv_seconds(row))
            peaks[method_split].append(float(row["peak_mb"]))
    return _means(seconds), _means(peaks)


def core_seconds(sweep: Path) -> float:
    """Processor seconds of all stages of all points; results that points share count once."""
    rows = [row for path in sweep.glob("*/reports/cost.csv") for row in read_csv(path)]
    distinct = {tuple(row.values()): row for row in rows}.values()
    return sum(csv_seconds(row) + csv_seconds(row, "extra_") for row in distinct)


def _means(groups: dict[tuple[str, str], list[float]]) -> dict[tuple[str, str], float]:
    return {method_split: fmean(values) for method_split, values in groups.items()}


def read_published_sweep(folder: Path) -> tuple[list[SweepPoint], list[str]]:
    """The points of `folder` and the swept keys; single parts are not published."""
    rows = read_csv(folder / "sweep.csv")
    heads = list(rows[0])
    swept = heads[1 : heads.index("method")]
    numbers = dict.fromkeys(int(row["point"]) for row in rows)
    return [
        _published_point(number, [row for row in rows if int(row["point"]) == number], swept)
        for number in numbers
    ], swept


def _published_point(number: int, rows: list[dict[str, str]], swept: list[str]) -> SweepPoint:
    params = {key: _parse_value(rows[0][key]) for key in swept}
    return SweepPoint(number, params, 0.0, [_published_result(row) for row in rows], {})


def _parse_value(text: str) -> int | float | str:
    for convert in (int, float):
        try:
            return convert(text)
        except ValueError:
            pass
    return text


def _published_result(row: dict[str, str]) -> PointResult:
    low, high, emd_mm, seconds, peak_mb = (
        optional_float(row.get(name)) for name in ("low", "high", "emd_mm", "seconds", "peak_mb")
    )
    num_parameters = int(row["parameters"]) if row.get("parameters") else None
    means = (float(row["emd"]), low, high, emd_mm, float(row["x floor"]))
    return PointResult(row["method"], row["split"], *means, seconds, peak_mb, num_parameters, {})
