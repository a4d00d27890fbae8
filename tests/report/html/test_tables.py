"""Tables of the page, from values that are known."""

import re

from industnerf.report.html.page import environment
from industnerf.report.html.tables import (
    Cell,
    Column,
    HtmlRow,
    comparisons_table,
    html_table,
    strata_table,
)
from industnerf.report.statistics.comparisons import Comparison
from industnerf.report.tables.strata import ALL, StratumRow

COMPARISON = Comparison(
    "industnerf", "hull<b>", -0.0123, -0.02, -0.001, -1.25, 0.004, 0.008, 0.75, 96, 16
)


def render(table) -> str:
    return environment().get_template("macros.html.j2").module.table(table)


def texts(table) -> list[list[str]]:
    """The cells of every row as the page has them, without their tags."""
    html = render(table)
    rows = re.findall(r"<tr[^>]*>(.*?)(?=<tr|</tbody|</thead)", html, re.DOTALL)
    return [
        [re.sub("<[^>]*>", "", cell) for cell in re.split("<t[hd][^>]*>", row)[1:]] for row in rows
    ]


def make_stratum(name: str, method: str, emd: float, parts: int) -> StratumRow:
    return StratumRow(name, method, emd, emd, emd, 100 * emd, 0.01, emd / 0.01, parts, 2, 0)


def test_a_comparison_is_a_row_with_its_interval_named():
    heads, row = texts(comparisons_table([COMPARISON], 0.9))
    by_header = dict(zip(heads, row, strict=True))
    assert by_header["difference"] == "-0.0123"
    assert by_header["90 %"] == "-0.0200 to -0.0010"
    assert by_header["mm"] == "-1.25"
    assert by_header["p (Holm)"] == "0.008"
    assert by_header["against"] == "hull&lt;b&gt;"


def test_a_stratum_is_a_column_and_a_method_a_row():
    rows = [
        make_stratum(ALL, "hull", 0.02, 9),
        make_stratum(ALL, "box", 0.2, 9),
        make_stratum("pockets", "box", 0.3, 4),
        make_stratum("pockets", "hull", 0.05, 4),
    ]
    heads, first, second = texts(strata_table(rows))
    assert heads == ["method", f"{ALL} (9)", "pockets (4)"]
    assert first == ["hull", "0.0200 2.00 mm", "0.0500 5.00 mm"]
    assert second == ["box", "0.2000 20.0 mm", "0.3000 30.0 mm"]


def test_of_nothing_there_is_nothing():
    assert comparisons_table([], 0.95) is None
    assert strata_table([]) is None


def test_a_table_leaves_out_the_columns_that_no_row_fills():
    columns = [Column("a", True), Column("b"), Column("c")]
    text = render(html_table(columns, [HtmlRow(["x", "", "1"]), HtmlRow(["y", "", ""], "failed")]))
    assert re.findall(r"<button>(\w)", text) == ["a", "c"]
    assert "<tr class=failed><td class=text>y<td></tbody>" in text


def test_a_link_survives_any_id():
    text = render(html_table([Column("a")], [HtmlRow([Cell("<x>", part_id="a b#'c")])]))
    assert "<td><a href='#part=a%20b%23%27c'>&lt;x&gt;</a>" in text
