"""The table of the grid, from cells whose means are known."""

import csv
import io

import pytest

from industnerf.artifacts.files import write_json
from industnerf.errors import BadArtifact
from industnerf.report.html.page import environment
from industnerf.report.html.tables import grid_table
from industnerf.report.tables.protocol_grid import (
    grid_csv,
    grid_md,
    grid_rows,
    load_published_grid,
    read_grid,
)


def cell(points, value, cost="distance"):
    protocol = {"points": points, "reduction": "even", "surface": "visible"}
    return protocol | {"cost": cost, "scale": "diagonal", "value": value}


DIAGONALS_MM = {"a": 100.0, "b": 200.0}
CELLS = {
    "a": {"floor": [cell(1024, 0.03), cell(4096, 0.01)], "hull": [cell(1024, 0.05)]},
    "b": {
        "floor": [cell(1024, 0.01), cell(4096, 0.01)],
        "hull": [cell(1024, 0.07), cell(4096, 0.02)],
    },
}


def test_squares_have_digits_enough():
    cells = [cell(4096, 0.00012, "squared"), cell(4096, 0.012)]
    text = grid_md(grid_rows({"a": {"floor": cells}}, DIAGONALS_MM))
    assert "| squared | diagonal | 0.000120 | 1.20 mm² |" in text
    assert "| distance | diagonal | 0.0120 | 1.20 |" in text


def test_in_mm_every_scale_is_the_same_part_by_part():
    """0.03 of 100 mm and 0.01 of 200: the mean is 2.5 mm, not 0.02 of 150."""
    longest = {**cell(1024, 0.5), "scale": "longest"}
    cells = {part: {"floor": [*of["floor"], longest]} for part, of in CELLS.items()}
    mm_by_scale = {
        grid_row.cell[-1]: grid_row.mm
        for grid_row in grid_rows(cells, DIAGONALS_MM)
        if grid_row.cell[0] == 1024
    }
    assert mm_by_scale == {
        scale: {"floor": pytest.approx(2.5)} for scale in ("diagonal", "longest")
    }


def test_a_table_of_before_there_were_mm_is_read(written):
    text = (written / "grid.csv").read_text()
    (written / "grid.csv").write_text(
        "".join(f"{row.rsplit(',', 2)[0]}\n" for row in text.splitlines())
    )
    assert "mm" not in grid_md(read_grid(written / "grid.csv"))


def test_means_are_over_the_parts_that_every_subject_has():
    many, few = sorted(
        grid_rows(CELLS, DIAGONALS_MM), key=lambda grid_row: grid_row.parts, reverse=True
    )
    assert (many.parts, few.parts) == (2, 1)
    assert many.means == pytest.approx({"floor": 0.02, "hull": 0.06})
    assert few.means == {"floor": 0.01, "hull": 0.02}


def test_the_papers_number_is_impossible_where_the_floor_is_above_it():
    text = grid_md(grid_rows(CELLS, DIAGONALS_MM))
    rows = {row.split("|")[1].strip(): row for row in text.splitlines()[2:]}
    assert "no: the floor is above it" in rows["1024"]  # 0.0122 of the paper, 0.02 of the floor
    assert rows["4096"].rstrip().endswith("| yes |")


def test_the_file_has_a_row_for_every_subject():
    rows = list(csv.DictReader(io.StringIO(grid_csv(grid_rows(CELLS, DIAGONALS_MM)))))
    assert [(r["points"], r["subject"], r["mean"], r["possible"]) for r in rows] == [
        ("1024", "floor", "0.02", "0"),
        ("1024", "hull", "0.06", "0"),
        ("4096", "floor", "0.01", "1"),
        ("4096", "hull", "0.02", "1"),
    ]


@pytest.fixture
def written(tmp_path):
    (tmp_path / "grid.csv").write_text(grid_csv(grid_rows(CELLS, DIAGONALS_MM)))
    write_json(tmp_path / "made.json", {"schema": 1, "commit": "0123456789", "date": "2026-01-02"})
    return tmp_path


def test_what_was_written_is_read(written):
    again = read_grid(written / "grid.csv")
    assert grid_md(again) == grid_md(grid_rows(CELLS, DIAGONALS_MM))
    assert [grid_row.cell for grid_row in again] == [
        grid_row.cell for grid_row in grid_rows(CELLS, DIAGONALS_MM)
    ]


def test_the_page_shows_every_cell_and_which_study_it_is_of(written):
    grid = load_published_grid(written)
    sections = environment().get_template("sections.html.j2").module
    text = sections.protocol_grid(grid_table(grid.rows), grid)
    assert text.count("<tr>") == 1 + len(grid_rows(CELLS, DIAGONALS_MM))
    assert "<td>0.0600" in text
    assert "commit 0123456, 2026-01-02," in text


def test_without_a_grid_the_page_says_nothing_of_it(tmp_path):
    assert load_published_grid(tmp_path / "nowhere") is None


def test_a_file_that_is_no_grid_is_an_error(written):
    (written / "grid.csv").write_text("a,b\n1,2\n")
    with pytest.raises(BadArtifact, match=r"grid\.csv is no table of a grid"):
        load_published_grid(written)
