"""The table of the grid, from cells whose means are known."""

import csv
import io

import pytest

from industnerf.report.grid import grid_csv, grid_md, lines


def cell(points, value):
    about = {"points": points, "reduction": "even", "surface": "visible"}
    return about | {"cost": "distance", "scale": "diagonal", "value": value}


CELLS = {
    "a": {"floor": [cell(1024, 0.03), cell(4096, 0.01)], "hull": [cell(1024, 0.05)]},
    "b": {
        "floor": [cell(1024, 0.01), cell(4096, 0.01)],
        "hull": [cell(1024, 0.07), cell(4096, 0.02)],
    },
}


def test_means_are_over_the_parts_that_every_subject_has():
    many, few = sorted(lines(CELLS), key=lambda line: line.parts, reverse=True)
    assert (many.parts, few.parts) == (2, 1)
    assert many.means == pytest.approx({"floor": 0.02, "hull": 0.06})
    assert few.means == {"floor": 0.01, "hull": 0.02}


def test_the_papers_number_is_impossible_where_the_floor_is_above_it():
    text = grid_md(lines(CELLS))
    rows = {row.split("|")[1].strip(): row for row in text.splitlines()[2:]}
    assert "no: the floor is above it" in rows["1024"]  # 0.0122 of the paper, 0.02 of the floor
    assert rows["4096"].rstrip().endswith("| yes |")


def test_the_file_has_a_row_for_every_subject():
    rows = list(csv.DictReader(io.StringIO(grid_csv(lines(CELLS)))))
    assert [(r["points"], r["subject"], r["mean"], r["possible"]) for r in rows] == [
        ("1024", "floor", "0.020000", "0"),
        ("1024", "hull", "0.060000", "0"),
        ("4096", "floor", "0.010000", "1"),
        ("4096", "hull", "0.020000", "1"),
    ]
