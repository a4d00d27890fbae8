"""What methods cost, from side-cars that are known."""

from dataclasses import fields

import pytest

from industnerf.artifacts.files import write_json
from industnerf.report.study import StudyFolders
from industnerf.report.tables.costs import (
    CostRow,
    add_cost,
    costs_csv,
    format_row,
    method_costs,
    read_costs,
    seconds_per_part,
)
from industnerf.report.tables.formats import read_csv
from industnerf.store import Cost, Store
from tests.samples import unit_part
from tests.studies import make_study

PARTS = [unit_part(name, name) for name in "ab"]
COSTS = [
    CostRow("reconstruct", "hull", "a", Cost(1.0, 100.0, "cpu", 0.5)),
    CostRow("reconstruct", "hull", "b", Cost(3.0, 300.0, "cpu", 1.5)),
    CostRow("evaluate", "hull", "a", Cost(7.0, 100.0, "cpu")),
    CostRow("train", "r2n2", "fold-0", Cost(60.0, 500.0, "cpu")),
    CostRow("train", "r2n2", "fold-1", Cost(180.0, 700.0, "cpu")),
]


def test_a_line_holds_means_and_of_memory_the_largest_peak():
    study = make_study(PARTS, {"r2n2": [0.1, 0.1], "hull": [0.1, 0.1]})
    hull, net = method_costs(study, COSTS)
    assert (hull.method, net.method) == ("hull", "r2n2")
    assert (hull.seconds, hull.extra_seconds, hull.peak_mb, hull.scoring_seconds) == (
        2.0,
        1.0,
        300.0,
        7.0,
    )
    assert (net.networks, net.network_minutes, net.network_peak_mb) == (2, 2.0, 700.0)
    assert net.seconds is None
    assert format_row(net)[1] == ""


def test_seconds_are_those_of_the_parts_asked_for():
    assert seconds_per_part(COSTS, "hull", {"b"}) == pytest.approx(3.0)
    assert seconds_per_part(COSTS, "hull", {"c"}) is None


def test_the_report_adds_what_it_cost_itself(tmp_path):
    table = tmp_path / "cost.csv"
    table.write_text(costs_csv(COSTS))
    add_cost(table, CostRow("report", "", "", Cost(9.0, 700.0, "cpu")))
    assert len(read_csv(table)) == len(COSTS) + 1
    assert list(read_csv(table)[-1].values()) == ["report", "", "", "9.0", "700.0", "cpu", "0.0"]


def test_solids_are_counted_where_the_store_knows_them(tmp_path, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_STORE", str(tmp_path / "store"))
    Store.from_environment().put("solids", "0" * 32, lambda _: Cost(4.0, 9.0, "cpu"))
    for name in ("solids", "parts", "views", "truth"):
        keys = {"bracket": "0" * 32} if name == "solids" else {}
        write_json(tmp_path / name / "index.json", {"schema": 1, "keys": keys})
    (row,) = read_costs(
        StudyFolders(*(tmp_path / field.name for field in fields(StudyFolders))), []
    )
    assert (row.stage, row.part_id, row.cost.seconds) == ("solids", "bracket", 4.0)
