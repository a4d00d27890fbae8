"""What methods cost, from side-cars that are known."""

from dataclasses import fields, replace

import pytest

from industnerf.artifacts.files import write_json
from industnerf.report.study import StudyFolders
from industnerf.report.tables.costs import (
    CPU_TIME_NOTE,
    WALL_TIME_NOTE,
    CostRow,
    add_cost,
    cost_table_md,
    costs_csv,
    csv_seconds,
    format_row,
    method_costs,
    read_costs,
    seconds_label,
    seconds_per_part,
)
from industnerf.report.tables.formats import read_csv
from industnerf.store import Cost, Store
from tests.samples import unit_part
from tests.studies import make_study

PARTS = [unit_part(name, name) for name in "ab"]
COSTS = [
    CostRow("reconstruct", "hull", "a", Cost(2.0, 100.0, "cpu", 5.0, 1.0, 0.5)),
    CostRow("reconstruct", "hull", "b", Cost(6.0, 300.0, "cpu", 9.0, 3.0, 1.5)),
    CostRow("evaluate", "hull", "a", Cost(14.0, 100.0, "cpu", 0.0, 7.0, 0.0)),
    CostRow("train", "r2n2", "fold-0", Cost(120.0, 500.0, "cpu", 0.0, 60.0, 0.0)),
    CostRow("train", "r2n2", "fold-1", Cost(360.0, 700.0, "cpu", 0.0, 180.0, 0.0)),
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
    assert not hull.is_wall_time
    assert format_row(net)[1] == ""


def test_older_results_have_wall_seconds_and_say_so():
    older = [
        replace(row, cost=replace(row.cost, cpu_seconds=None, extra_cpu_seconds=None))
        for row in COSTS
    ]
    study = make_study(PARTS, {"r2n2": [0.1, 0.1], "hull": [0.1, 0.1]})
    hull, _ = method_costs(study, older)
    assert (hull.seconds, hull.extra_seconds, hull.is_wall_time) == (4.0, 7.0, True)
    for costs, note in ((older, WALL_TIME_NOTE), (COSTS, CPU_TIME_NOTE)):
        assert note in cost_table_md(method_costs(study, costs))


def test_the_seconds_of_a_file_are_named():
    old = {"seconds": "3", "extra_seconds": "2"}
    new = {"seconds": "3", "extra_seconds": "2", "cpu_seconds": "1.5", "extra_cpu_seconds": "0"}
    assert [csv_seconds(old), csv_seconds(old, "extra_"), seconds_label([old, new])] == [
        3.0,
        2.0,
        "wall seconds",
    ]
    assert [csv_seconds(new), csv_seconds(new, "extra_"), seconds_label([new])] == [
        1.5,
        0.0,
        "processor seconds",
    ]


def test_seconds_are_those_of_the_parts_asked_for():
    assert seconds_per_part(COSTS, "hull", {"b"}) == pytest.approx(3.0)
    assert seconds_per_part(COSTS, "hull", {"c"}) is None


def test_the_report_adds_what_it_cost_itself(tmp_path):
    table = tmp_path / "cost.csv"
    table.write_text(costs_csv(COSTS))
    add_cost(table, CostRow("report", "", "", Cost(9.0, 700.0, "cpu", 0.0, 8.0, 0.0)))
    assert len(read_csv(table)) == len(COSTS) + 1
    last = "report,,,9.0,700.0,cpu,0.0,8.0,0.0"
    assert list(read_csv(table)[-1].values()) == last.split(",")


@pytest.mark.parametrize("stage", ["solids", "procedural"])
def test_stages_without_methods_are_counted_where_the_store_knows_them(
    tmp_path, monkeypatch, stage
):
    monkeypatch.setenv("INDUSTNERF_STORE", str(tmp_path / "store"))
    Store.from_environment().put(stage, "0" * 32, lambda _: Cost(4.0, 9.0, "cpu"))
    folders = StudyFolders(*(tmp_path / field.name for field in fields(StudyFolders)))
    for name in ("solids", "parts", "views", "truth", "procedural"):
        keys = {"bracket": "0" * 32} if name == stage else {}
        write_json(tmp_path / name / "index.json", {"schema": 1, "keys": keys})
    (row,) = read_costs(folders, [])
    assert (row.stage, row.part_id, row.cost.seconds) == (stage, "bracket", 4.0)
