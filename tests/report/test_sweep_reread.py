"""A published sweep can be drawn anew, and its front is marked."""

from pathlib import Path

import pytest
from matplotlib.figure import Figure

from industnerf.report.formats import csv_rows
from industnerf.report.sweep_plot import FRONT, plot
from industnerf.report.sweep_points import SELECT, Result
from industnerf.report.sweep_reread import reread_sweep
from industnerf.report.sweep_series import Series, series, trends

PUBLISHED = [
    path
    for path in sorted((Path(__file__).parents[2] / "docs/sweeps").glob("*/sweep.csv"))
    if SELECT not in path.read_text().splitlines()[0]  # the faces of its parts are not kept
]


@pytest.mark.parametrize("table", PUBLISHED, ids=lambda path: path.parent.name)
def test_what_is_read_back_grows_as_was_published(table):
    """A second kept with two decimals is off by 0.005, a hundredth at 0.5 s: so much, over the
    factor of four or more that is swept, is 0.01 / ln 4 in an exponent.
    """
    points, swept = reread_sweep(table.parent)
    found = {(t.label, t.quantity): t.law.exponent for t in trends(series(points, swept), swept[0])}
    wanted = {
        (row["series"], row["quantity"]): float(row["exponent"])
        for row in csv_rows(table.with_name("trend.csv"))
    }
    assert found == pytest.approx(wanted, abs=0.0072)


@pytest.mark.parametrize(
    ("columns", "cells", "found"),
    [(",emd_mm,numbers", ",2.47,8", (2.47, 8)), ("", "", (None, None))],
)
def test_a_table_of_before_has_no_mm_and_no_numbers(tmp_path, columns, cells, found):
    (tmp_path / "sweep.csv").write_text(
        f"point,n,method,split,emd,low,high,x floor,seconds,peak_mb{columns}\n"
        f"0,1,hull,dev,0.018,0.01,0.02,1.7,,200{cells}\n"
    )
    ((point,), _) = reread_sweep(tmp_path)
    (result,) = point.results
    assert (result.emd_mm, result.numbers) == found
    assert (result.ratio, result.seconds, result.peak_mb) == (1.7, None, 200.0)


def axes(key, *sweeps, path, monkeypatch):
    """The axes of the plot of `sweeps`, each of seconds, EMD and maybe numbers learned."""
    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda self, *_, **__: figures.append(self))
    lines = [
        Series(
            f"m{i}",
            list(range(len(points))),
            [
                Result("m", "dev", emd, emd, emd, None, 1.0, s, None, *(learned or [None]), {})
                for s, emd, *learned in points
            ],
        )
        for i, points in enumerate(sweeps)
    ]
    plot(lines, [], key, path)
    return figures[0].axes


def drawn(*arguments, **where):
    """The red lines of the plot."""
    axis = axes(*arguments, **where)[-1]
    return [line.get_xydata().tolist() for line in axis.lines if line.get_color() == FRONT]


PAIRS = [(1.0, 0.3), (2.0, 0.4), (3.0, 0.1), (4.0, 0.1)]


def test_the_front_of_a_setting_is_marked(tmp_path, monkeypatch):
    """At 2 s the EMD is worse than at 1 s, and at 4 s no better than at 3 s."""
    where = {"path": tmp_path / "sweep.png", "monkeypatch": monkeypatch}
    assert drawn("method.m.size", PAIRS, **where) == [[[1.0, 0.3], [3.0, 0.1]]]


def test_points_of_different_tasks_or_methods_do_not_compete(tmp_path, monkeypatch):
    where = {"path": tmp_path / "sweep.png", "monkeypatch": monkeypatch}
    assert drawn("views.count", PAIRS, **where) == []
    assert drawn("method.m.size", PAIRS, PAIRS, **where) == []


SIZES = [(9.0, 0.3, 20), (8.0, 0.4, 30), (7.0, 0.1, 40)]


def test_the_price_of_a_setting_is_the_numbers_learned_where_it_changes_them(tmp_path, monkeypatch):
    """In seconds the largest would be both the quickest and the best."""
    where = {"path": tmp_path / "sweep.png", "monkeypatch": monkeypatch}
    assert drawn("method.m.size", SIZES, **where) == [[[20, 0.3], [40, 0.1]]]
    assert drawn("method.m.size", [(s, emd, 20) for s, emd, _ in SIZES], **where) == [[[7.0, 0.1]]]


@pytest.mark.parametrize(
    ("key", "others", "price"),
    [
        ("method.m.size", [(1.0, 0.2, 50)] * 3, "numbers learned"),
        ("method.m.size", [(1.0, 0.2, 0)] * 3, "s a part"),
        ("views.count", [(1.0, 0.2, 50)] * 3, "s a part"),
    ],
)
def test_the_price_is_seconds_where_one_learns_nothing_or_views_change_what_is_learned(
    tmp_path, monkeypatch, key, others, price
):
    where = {"path": tmp_path / "sweep.png", "monkeypatch": monkeypatch}
    assert axes(key, SIZES, others, **where)[-1].get_xlabel() == price


@pytest.mark.parametrize(("most", "scale"), [(3.9, "linear"), (4.1, "log")])
def test_seconds_that_hardly_differ_stand_on_an_axis_with_numbers(
    tmp_path, monkeypatch, most, scale
):
    """Between 1400 and 1430 a logarithmic axis has no tick that is labelled."""
    where = {"path": tmp_path / "sweep.png", "monkeypatch": monkeypatch}
    _, seconds, memory, exchange = axes("views.count", [(1.0, 0.3), (most, 0.1)], **where)
    assert (seconds.get_yscale(), exchange.get_xscale()) == (scale, scale)
    assert (seconds.get_ylim()[0] == 0) == (scale == "linear")
    assert memory.get_yscale() == "linear"  # of which nothing is known
