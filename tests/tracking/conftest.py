"""A small study on disk: three test parts and a dev part, a method that learns and one that not."""

import csv
import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from industnerf.artifacts.history import History
from industnerf.config import read_yaml

PARTS = {  # id: family, split, fold
    "gear-a": ("gears", "test", 0),
    "gear-b": ("gears", "test", 0),
    "nut-a": ("nuts", "test", 1),
    "nut-b": ("nuts", "dev", 1),
}
EMD = {"hull": (0.01, 0.02, 0.03, 0.5), "net": (0.04, 0.05, 0.06, 0.7)}  # in the order of PARTS
FLOOR = 0.005
SECONDS = {"hull": (1, 2, 6, 100), "net": (3, 4, 5, 200)}
PARAMS = """\
preset: smoke
seed: 0
parts: {path: data/embedded}
views: {count: 6, radius: 4.1}
reconstruct: {views: 0}
train: {epochs: 3}
methods: [hull, net]
method: {hull: {points: 2048, grid_res: 32}, net: {points: 512}}
"""


def write_csv(path: Path, rows: list[Mapping]) -> None:
    with path.open("w") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def _scores(emd: Mapping[str, tuple[float, ...]]) -> list[Mapping]:
    rows = []
    for method, values in emd.items():
        for (part, (family, split, _)), value in zip(PARTS.items(), values, strict=True):
            own = {"part_id": part, "family": family, "method": method, "split": split}
            own |= {"scope": "dataset" if method == "net" else "part", "status": "ok"}
            for protocol, factor in (("P1-even", 1), ("P1-iid", 2)):
                score = {"metric": "emd", "protocol": protocol, "value": factor * value}
                rows.append(own | score | {"floor": FLOOR})
            rows.append(own | {"metric": "chamfer", "protocol": "P1-dense", "value": 10 * value})
    return rows


def _table1(emd: Mapping[str, tuple[float, ...]]) -> list[Mapping]:
    shared = {"preset": "smoke", "ci_low": 0.001, "ci_high": 1, "seeds_sd": "", "steps": 0}
    return [
        {"method": method, "split": split, "emd_mm": 1e3 * values[0], "parameters": 7, **shared}
        | {"scope": "dataset" if method == "net" else "part", "inputs": "rgb"}
        for split in ("test", "dev")
        for method, values in emd.items()
    ]


def _costs() -> list[Mapping]:
    rows = [
        {"stage": "reconstruct", "method": method, "part_id": part, "seconds": 99}
        | {"peak_mb": 10 * seconds, "cpu_seconds": seconds}
        for method, all_seconds in SECONDS.items()
        for part, seconds in zip(PARTS, all_seconds, strict=True)
    ]
    trained = [
        {"stage": "train", "method": "net", "part_id": f"fold-{fold}", "seconds": 40 + fold}
        | {"peak_mb": 500 + fold, "cpu_seconds": 30 + fold}
        for fold in (0, 1)
    ]
    return rows + trained


def write_report(folder: Path, emd: Mapping[str, tuple[float, ...]] = EMD) -> Path:
    """`reports` of a finished study below `folder`, and what the stages before it wrote."""
    report = folder / "reports"
    report.mkdir(parents=True)
    write_csv(report / "scores.csv", _scores(emd))
    write_csv(report / "table1.csv", _table1(emd))
    write_csv(report / "cost.csv", _costs())
    (report / "report.html").write_text("<html>")
    (folder / "params.yaml").write_text(PARAMS)
    data = folder / "data"
    for fold in (0, 1):
        state = data / "states" / "net" / f"fold-{fold}"
        (state / "validation").mkdir(parents=True)
        History(np.array([0, 5]), np.array([1.0, 0.5]) - 0.25 * fold, {}).save(state)
        History(np.array([4]), np.array([0.75]), {}).save(state / "validation")
    parts = {part: {"split": split, "fold": fold} for part, (_, split, fold) in PARTS.items()}
    (data / "split.json").write_text(json.dumps({"schema": 2, "parts": parts}))
    cloud = data / "clouds" / "net" / "gear-a"
    cloud.mkdir(parents=True)
    History(np.array([0, 9]), np.array([0.5, 0.25]), {}).save(cloud)
    return report


def write_sweep(folder: Path, counts: tuple[int, ...] = (4, 8)) -> Path:
    """The folder of a sweep over `views.count` and a setting of the hull that follows it."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "multirun.yaml").write_text("hydra: {}")
    (folder / "sweep.csv").write_text("point\n")
    for i, count in enumerate(counts):
        if (folder / str(i)).exists():
            continue
        emd = {name: tuple(value / count for value in values) for name, values in EMD.items()}
        report = write_report(folder / str(i), emd)
        (report / "label.json").write_text(json.dumps({"point": f"views.count={count} x='my y'"}))
        params = PARAMS.replace("count: 6", f"count: {count}")
        params = params.replace("grid_res: 32", f"grid_res: {8 * count}")
        (folder / str(i) / "params.yaml").write_text(params)
    return folder


@pytest.fixture
def report(tmp_path) -> Path:
    return write_report(tmp_path / "study")


@pytest.fixture
def params(report) -> dict:
    return read_yaml(report.parent / "params.yaml")
