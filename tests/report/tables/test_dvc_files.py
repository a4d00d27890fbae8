"""What DVC shows of a report: the numbers of Table 1, a file a method, and rows that plots draw."""

import csv
import io
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from industnerf.artifacts.files import write_json
from industnerf.artifacts.history import History
from industnerf.report.results import Results
from industnerf.report.study import StudyFolders
from industnerf.report.tables.costs import CostRow
from industnerf.report.tables.dvc_files import (
    CURVES,
    MAX_CURVE_POINTS,
    curves_csv,
    dvc_file_texts,
)
from industnerf.store import Cost
from tests.samples import unit_part
from tests.studies import SETTINGS, make_study

PARTS = [unit_part(name, name) for name in "abc"]
ROOT = Path(__file__).parents[3]


def results(**emds):
    study = make_study(PARTS, emds, dev="c")
    costs = [
        CostRow("reconstruct", "hull", part, Cost(9.0, 5.0, "cpu", 0.0, seconds, 0.0))
        for part, seconds in (("a", 1.0), ("b", 2.0), ("c", 30.0))
    ]
    return Results.from_study(study, SETTINGS, costs)


def rows(text):
    return list(csv.DictReader(io.StringIO(text)))


def test_the_numbers_of_a_method_are_those_of_its_row_over_test_parts():
    texts = dvc_file_texts(results(hull=[0.02, 0.04, 0.9], ball=[0.1, 0.3, 0.9]))
    hull, ball = (json.loads(texts[f"metrics/{name}.json"]) for name in ("hull", "ball"))
    assert list(hull) == ["emd", "emd_ratio", "floor", "failures", "seconds"]
    assert (hull["emd"], hull["failures"], hull["seconds"]) == (0.03, 0, 1.5)
    assert hull["emd_ratio"] == pytest.approx(hull["emd"] / hull["floor"], rel=1e-5)
    assert (ball["emd"], ball["seconds"]) == (0.2, None)  # the store does not know its seconds


def test_a_failure_is_counted():
    texts = dvc_file_texts(results(hull=[0.02, float("inf"), 0.9], ball=[0.1, 0.3, 0.9]))
    assert json.loads(texts["metrics/hull.json"])["failures"] == 1


def test_plots_have_a_row_for_every_part_and_for_every_method_of_known_seconds():
    texts = dvc_file_texts(results(hull=[0.02, 0.04, 0.9], ball=[0.1, 0.3, 0.9]))
    emd = {(row["part_id"], row["method"]): row["emd"] for row in rows(texts["plots/emd.csv"])}
    assert emd == {
        ("a", "hull"): "0.02",
        ("b", "hull"): "0.04",
        ("a", "ball"): "0.1",
        ("b", "ball"): "0.3",
    }
    (point,) = rows(texts["plots/pareto.csv"])
    assert point == {
        "method": "hull",
        "seconds": "1.5",
        "emd": "0.03",
        "role": "method",
        "front": "yes",
    }


def write_history(folder, steps, losses):
    folder.mkdir(parents=True)
    History(np.array(steps), np.array(losses, float), {}).save(folder)


def test_curves_are_those_of_networks_and_the_median_of_parts(tmp_path):
    study = make_study(PARTS, {"r2n2": [0.1] * 3, "nerf": [0.1] * 3})
    folders = StudyFolders(*(tmp_path / name for name in StudyFolders.__dataclass_fields__))
    write_history(folders.states / "r2n2/fold-0", [0, 1], [3, 2])
    write_history(folders.states / "r2n2/fold-0/validation", [1], [2.5])
    many = list(range(1001))
    for part, loss in zip("abc", (1.0, 7.0, 2.0), strict=True):
        write_history(folders.clouds / "nerf" / part, many, [loss] * 1001)
    for folder, names in (
        (folders.states / "r2n2", ["fold-0"]),
        (folders.clouds / "r2n2", []),
        (folders.clouds / "nerf", "abc"),
    ):
        record = {"schema": 1, "step": "s", "keys": dict.fromkeys(names, "")}
        write_json(folder / "index.json", record)
    curves = rows(curves_csv(replace(study, folders=folders)))
    assert [tuple(row.values()) for row in curves[:3]] == [
        ("r2n2", "fold-0", "0", "3"),
        ("r2n2", "fold-0", "1", "2"),
        ("r2n2", "fold-0, held out", "1", "2.5"),
    ]
    assert {(*tuple(row.values())[:2], row["loss"]) for row in curves[3:]} == {
        ("nerf", "median part", "2")
    }
    assert MAX_CURVE_POINTS / 2 < len(curves[3:]) <= MAX_CURVE_POINTS + 1
    assert curves[-1]["step"] == "1000"


def test_dvc_is_told_of_every_file_and_of_columns_that_it_has():
    pipeline = yaml.safe_load((ROOT / "dvc.yaml").read_text())
    texts = dvc_file_texts(results(hull=[0.02, 0.04, 0.9])) | {CURVES: "method,curve,step,loss\n"}
    assert pipeline["metrics"] == ["reports/metrics", "results/study/metrics"]
    plots = [plot for entry in pipeline["plots"] for plot in entry.values()]
    assert {f"reports/{name}" for name in texts if "plots/" in name} == {
        path for plot in plots for path in plot["y"] if path.startswith("reports")
    }
    for plot in plots:
        template = (ROOT / plot["template"]).read_text()
        json.loads(template)
        for path, column in plot["y"].items():
            name = path.removeprefix("reports/").removeprefix("results/study/")
            columns = texts[name].splitlines()[0].split(",")
            fields = set(re.findall(r'"field": "(\w+)"', template)) - {"rev", "run"}
            assert {plot["x"], column, *fields} - {"DVC_METRIC_X", "DVC_METRIC_Y"} <= set(columns)
