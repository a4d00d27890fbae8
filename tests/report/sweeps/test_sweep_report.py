"""The tables and the plot of a sweep, from reports made up for the purpose."""

import csv
import json
from pathlib import Path

import pytest
import yaml
from PIL import Image

from industnerf.report.sweeps.points import read_points, read_published_sweep, swept_keys
from industnerf.report.sweeps.series import fit_trends, make_series
from industnerf.report.sweeps.sweep_report import write_sweep_report


def write_point(
    sweep: Path, number: int, params: dict, emd: float, seconds: float, faces: int = 10
):
    """One finished point: two parts, one method, costs `seconds` a part on average.

    The parts score 0.9 and 1.1 times `emd`.
    """
    folder = sweep / str(number)
    (folder / "reports").mkdir(parents=True)
    (folder / "params.yaml").write_text(yaml.safe_dump({"report": REPORT_PARAMS} | params))
    (folder / "reports/summary.json").write_text("{}")
    (folder / "reports/table1.csv").write_text(
        "method,split,emd_even,ci_low,ci_high,ratio_to_floor,emd_mm,parameters\n"
        f"hull,dev,{emd},{0.9 * emd},{1.3 * emd},2.5,{DIAGONAL_MM * emd},{NUM_PARAMETERS}\n"
    )
    (folder / "reports/scores.csv").write_text(
        "part_id,family,split,method,metric,protocol,value\n"
        f"p1,f1,dev,hull,emd,P1-even,{0.9 * emd}\n"
        f"p1,f1,dev,hull,emd,P1-iid,7\n"
        f"p2,f2,dev,hull,emd,P1-even,{1.1 * emd}\n"
    )
    (folder / "reports/cost.csv").write_text(
        "stage,method,part_id,seconds,peak_mb,device,extra_seconds\n"
        "views,,p1,1000,1000,cpu,0\n"
        f"reconstruct,hull,p1,{0.5 * seconds},100,cpu,0\n"
        f"reconstruct,hull,p2,{1.5 * seconds},300,cpu,0\n"
    )
    part = folder / "data/parts/p1"
    part.mkdir(parents=True)
    (part / "part.json").write_text(json.dumps({"faces": faces}))


DIAGONAL_MM = 130.0  # of either part
NUM_PARAMETERS = 12728
REPORT_PARAMS = {"bootstrap_resamples": 200, "confidence_level": 0.95, "contact_sheet_parts": 1}


def read_rows(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


@pytest.fixture
def sweep(tmp_path: Path) -> Path:
    """Time grows with the cube of the resolution."""
    for number, resolution in enumerate((40, 10, 20)):
        values = {"seed": 0, "views": {"resolution": resolution}}
        write_point(tmp_path, number, values, 1 / resolution, 1e-3 * resolution**3)
    return tmp_path


def test_a_row_has_emd_interval_and_costs(sweep: Path):
    assert write_sweep_report(sweep) == 0
    first = read_rows(sweep / "sweep.csv")[0]
    assert first == {
        "point": "0",
        "views.resolution": "40",
        "method": "hull",
        "split": "dev",
        "emd": "0.02500",
        "low": "0.02250",
        "high": "0.03250",
        "emd_mm": "3.2500",  # 0.025 of 130 mm
        "x floor": "2.500",
        "seconds": "64.00",
        "peak_mb": "200.00",
        "parameters": "12728",
    }


def test_each_step_has_the_mean_difference_of_its_parts(sweep: Path):
    """From 10 to 20 pixels the parts, of two families, score 0.045 and 0.055 less."""
    write_sweep_report(sweep)
    first, second = read_rows(sweep / "steps.csv")
    assert first == {
        "series": "hull",
        "from": "10",
        "to": "20",
        "EMD changes by": "-0.05000",
        "ci_low": "-0.05500",  # of two families a bootstrap draws one of them twice often enough
        "ci_high": "-0.04500",
        "parts": "2",
        "better on": "2",
    }
    assert (second["from"], second["to"], second["EMD changes by"]) == ("20", "40", "-0.02500")


def test_of_one_family_no_table_has_an_interval(tmp_path: Path):
    """Nor has the plot a bar; a published sweep of it is read back without one."""
    for number, resolution in enumerate((10, 20)):
        write_point(tmp_path, number, {"views": {"resolution": resolution}}, 1 / resolution, 1.0)
        reports = tmp_path / str(number) / "reports"
        (reports / "scores.csv").write_text(
            (reports / "scores.csv").read_text().replace("f2", "f1")
        )
        table1 = (reports / "table1.csv").read_text()
        head, row = table1.splitlines()
        cells = row.split(",")
        cells[3:5] = "", ""
        (reports / "table1.csv").write_text(f"{head}\n{','.join(cells)}\n")
    assert write_sweep_report(tmp_path) == 0
    assert {(row["low"], row["high"]) for row in read_rows(tmp_path / "sweep.csv")} == {("", "")}
    (step,) = read_rows(tmp_path / "steps.csv")
    assert (step["EMD changes by"], step["ci_low"], step["ci_high"]) == ("-0.05000", "", "")
    points, _ = read_published_sweep(tmp_path)
    assert {(result.low, result.high) for point in points for result in point.results} == {
        (None, None)
    }


def test_points_without_a_part_in_common_are_no_step(tmp_path: Path):
    for number, part in enumerate(("a", "b")):
        write_point(tmp_path, number, {"parts": {"select": [part]}}, 0.1, 1.0, faces=10 + number)
        scores = tmp_path / str(number) / "reports/scores.csv"
        scores.write_text(scores.read_text().replace("p1", f"{part}1").replace("p2", f"{part}2"))
    write_sweep_report(tmp_path)
    assert read_rows(tmp_path / "steps.csv") == []


def test_the_growth_of_costs_is_fitted(sweep: Path):
    write_sweep_report(sweep)
    time, memory = read_rows(sweep / "trend.csv")
    assert (time["quantity"], time["exponent"], time["points"]) == ("seconds", "3.000", "3")
    assert (memory["quantity"], memory["exponent"]) == ("peak_mb", "0.000")


def test_the_plot_is_a_picture_of_the_stated_size(sweep: Path):
    write_sweep_report(sweep)
    with Image.open(sweep / "sweep.png") as picture:
        assert picture.size == (640, 1060)


def test_an_unfinished_point_counts_as_failed(sweep: Path):
    (sweep / "3").mkdir()
    assert write_sweep_report(sweep) == 1


def test_without_costs_there_is_a_table_and_no_trend(sweep: Path):
    for path in sweep.glob("*/reports/cost.csv"):
        path.write_text("stage,method,part_id,seconds,peak_mb,device,extra_seconds\n")
    assert write_sweep_report(sweep) == 0
    assert read_rows(sweep / "sweep.csv")[0]["seconds"] == ""
    assert read_rows(sweep / "trend.csv") == []


def test_points_stand_in_the_order_of_their_numbers(sweep: Path):
    points = read_points(sweep)
    assert swept_keys(points) == ["views.resolution"]
    (only_series,) = make_series(points, ["views.resolution"])
    assert only_series.x == [10, 20, 40]
    assert [result.emd for result in only_series.results] == [0.1, 0.05, 0.025]


def test_a_second_swept_key_makes_lines_of_its_own(tmp_path: Path):
    for number, (count, noise) in enumerate([(4, 0.0), (4, 0.1), (8, 0.0), (8, 0.1)]):
        write_point(tmp_path, number, {"views": {"count": count, "noise": noise}}, 0.1, 1.0)
    points = read_points(tmp_path)
    series_list = make_series(points, swept_keys(points))
    assert [each_series.label for each_series in series_list] == [
        "hull views.noise=0.0",
        "hull views.noise=0.1",
    ]
    assert [each_series.x for each_series in series_list] == [[4, 8], [4, 8]]


def test_what_differs_in_a_list_of_sections_is_the_key_in_it(tmp_path: Path):
    for number, count in enumerate((5, 6, 7)):
        write_point(tmp_path, number, {"levels": [{"n": 1}, {"n": count}]}, 0.1, 1.0)
    assert swept_keys(read_points(tmp_path)) == ["levels[1].n"]


def test_parts_stand_by_how_many_faces_they_have(tmp_path: Path):
    for number, (name, faces) in enumerate([("a", 800), ("b", 100), ("c", 300)]):
        write_point(tmp_path, number, {"parts": {"select": [name]}}, 0.1, faces**2, faces)
    points = read_points(tmp_path)
    (only_series,) = make_series(points, swept_keys(points))
    assert only_series.x == [100, 300, 800]
    assert fit_trends([only_series], "parts.select")[0].law.exponent == pytest.approx(2.0)


def test_words_are_swept_in_their_order_and_without_trends(tmp_path: Path):
    for number, rig in enumerate(("sphere", "hemisphere", "rings")):
        write_point(tmp_path, number, {"rig": rig}, 0.1, 1.0)
    assert write_sweep_report(tmp_path) == 0
    assert read_rows(tmp_path / "trend.csv") == []
    (only_series,) = make_series(read_points(tmp_path), ["rig"])
    assert only_series.x == ["sphere", "hemisphere", "rings"]
