"""What methods cost, from side-cars that are known."""

from dataclasses import fields

import pytest

from industnerf.artifacts.files import write_json
from industnerf.report.costs import CostRow, add_cost, costs_csv, read_costs, seconds_per_part
from industnerf.report.formats import csv_rows
from industnerf.report.gather import Folders
from industnerf.report.spending import cells, spending
from industnerf.store import Cost, Store
from tests.samples import unit_part
from tests.studies import study_of

PARTS = [unit_part(name, name) for name in "ab"]
COSTS = [
    CostRow("reconstruct", "hull", "a", Cost(1.0, 100.0, "cpu", 0.5)),
    CostRow("reconstruct", "hull", "b", Cost(3.0, 300.0, "cpu", 1.5)),
    CostRow("evaluate", "hull", "a", Cost(7.0, 100.0, "cpu")),
    CostRow("train", "r2n2", "fold-0", Cost(60.0, 500.0, "cpu")),
    CostRow("train", "r2n2", "fold-1", Cost(180.0, 700.0, "cpu")),
]


def test_a_line_holds_means_and_of_memory_the_largest_peak():
    study = study_of(PARTS, {"r2n2": [0.1, 0.1], "hull": [0.1, 0.1]})
    hull, net = spending(study, COSTS)
    assert (hull.method, net.method) == ("hull", "r2n2")
    assert (hull.seconds, hull.aside_s, hull.peak_mb, hull.scoring_s) == (2.0, 1.0, 300.0, 7.0)
    assert (net.nets, net.net_minutes, net.net_peak_mb) == (2, 2.0, 700.0)
    assert net.seconds is None
    assert cells(net)[1] == ""


def test_seconds_are_those_of_the_parts_asked_for():
    assert seconds_per_part(COSTS, "hull", {"b"}) == pytest.approx(3.0)
    assert seconds_per_part(COSTS, "hull", {"c"}) is None


def test_the_report_adds_what_it_cost_itself(tmp_path):
    table = tmp_path / "cost.csv"
    table.write_text(costs_csv(COSTS))
    add_cost(table, CostRow("report", "", "", Cost(9.0, 700.0, "cpu")))
    assert len(csv_rows(table)) == len(COSTS) + 1
    assert list(csv_rows(table)[-1].values()) == ["report", "", "", "9.0", "700.0", "cpu", "0.0"]


def test_solids_are_counted_where_the_store_knows_them(tmp_path, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_STORE", str(tmp_path / "store"))
    Store.from_environment().put("solids", "0" * 32, lambda _: Cost(4.0, 9.0, "cpu"))
    for name in ("solids", "parts", "views", "truth"):
        keys = {"bracket": "0" * 32} if name == "solids" else {}
        write_json(tmp_path / name / "index.json", {"schema": 1, "keys": keys})
    (row,) = read_costs(Folders(*(tmp_path / field.name for field in fields(Folders))), [])
    assert (row.stage, row.part_id, row.cost.seconds) == ("solids", "bracket", 4.0)
