"""A published sweep can be drawn anew, and its front is marked."""

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from industnerf.report.sweeps.plot import FRONT_COLOR, plot_sweep
from industnerf.report.sweeps.points import SELECT_KEY, PointResult, read_published_sweep
from industnerf.report.sweeps.series import PowerLaw, Series, Trend, fit_trends, make_series
from industnerf.report.tables.formats import read_csv

PUBLISHED = [
    path
    for path in sorted((Path(__file__).parents[3] / "docs/reference/sweeps").glob("*/sweep.csv"))
    if SELECT_KEY not in path.read_text().splitlines()[0]  # the faces of its parts are not kept
]


@pytest.mark.parametrize("table", PUBLISHED, ids=lambda path: path.parent.name)
def test_what_is_read_back_grows_as_was_published(table):
    """A second kept with two decimals is off by 0.005, a hundredth at 0.5 s: so much, over the
    factor of four or more that is swept, is 0.01 / ln 4 in an exponent.
    """
    points, swept = read_published_sweep(table.parent)
    fitted = {
        (t.label, t.quantity): t.law.exponent
        for t in fit_trends(make_series(points, swept), swept[0])
    }
    expected = {
        (row["series"], row["quantity"]): float(row["exponent"])
        for row in read_csv(table.with_name("trend.csv"))
    }
    assert fitted == pytest.approx(expected, abs=0.0072)


@pytest.mark.parametrize(
    ("columns", "cells", "expected"),
    [(",emd_mm,parameters", ",2.47,8", (2.47, 8)), ("", "", (None, None))],
)
def test_a_table_of_before_has_no_mm_and_no_parameters(tmp_path, columns, cells, expected):
    (tmp_path / "sweep.csv").write_text(
        f"point,n,method,split,emd,low,high,x floor,seconds,peak_mb{columns}\n"
        f"0,1,hull,dev,0.018,0.01,0.02,1.7,,200{cells}\n"
    )
    ((point,), _) = read_published_sweep(tmp_path)
    (result,) = point.results
    assert (result.emd_mm, result.num_parameters) == expected
    assert (result.ratio_to_floor, result.seconds, result.peak_mb) == (1.7, None, 200.0)


def plot_axes(key, *sweeps, path, monkeypatch, spread=1, labels=None):
    """The axes of the plot of `sweeps`, each of seconds, EMD and maybe learned parameters.

    Intervals reach from 1 / `spread` to `spread` times the EMD.
    """
    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda self, *_, **__: figures.append(self))
    series_list = [
        Series(
            labels[i] if labels else f"m{i}",
            list(range(len(points))),
            [
                PointResult(
                    *("m", "dev", emd, emd / spread, emd * spread, None, 1.0, s, None),
                    *(learned or [None]),
                    {},
                )
                for s, emd, *learned in points
            ],
        )
        for i, points in enumerate(sweeps)
    ]
    plot_sweep(series_list, [], key, path)
    return figures[0].axes


def front_lines(*arguments, **options):
    """The red lines of the plot."""
    axis = plot_axes(*arguments, **options)[-1]
    return [line.get_xydata().tolist() for line in axis.lines if line.get_color() == FRONT_COLOR]


PAIRS = [(1.0, 0.3), (2.0, 0.4), (3.0, 0.1), (4.0, 0.1)]


def test_no_interval_ends_outside_the_plot(tmp_path, monkeypatch):
    options = {"path": tmp_path / "sweep.png", "monkeypatch": monkeypatch, "spread": 2}
    assert plot_axes("views.count", PAIRS, **options)[0].get_ylim()[1] > 2 * 0.4


@pytest.mark.parametrize(
    ("labels", "expected"),
    [
        (["carve", "industnerf_plus (test)"], ["C2", "C0"]),
        (["industnerf_plus", "carve"], ["C0", "C2"]),
        (["carve n=1", "carve n=2"], ["C0", "C1"]),
        (["carve", "a_new_method"], ["C0", "C1"]),
    ],
)
def test_a_method_has_its_color_in_every_plot(tmp_path, monkeypatch, labels, expected):
    """Unless one has none, or two lines are of one method."""
    options = {"path": tmp_path / "sweep.png", "monkeypatch": monkeypatch, "labels": labels}
    tradeoff = plot_axes("views.count", PAIRS, PAIRS, **options)[-1]
    assert [line.get_color() for line in tradeoff.lines] == expected


def test_the_front_of_a_setting_is_marked(tmp_path, monkeypatch):
    """At 2 s the EMD is worse than at 1 s, and at 4 s no better than at 3 s."""
    options = {"path": tmp_path / "sweep.png", "monkeypatch": monkeypatch}
    assert front_lines("method.m.size", PAIRS, **options) == [[[1.0, 0.3], [3.0, 0.1]]]


def test_points_of_different_tasks_or_methods_do_not_compete(tmp_path, monkeypatch):
    options = {"path": tmp_path / "sweep.png", "monkeypatch": monkeypatch}
    assert front_lines("views.count", PAIRS, **options) == []
    assert front_lines("method.m.size", PAIRS, PAIRS, **options) == []


SIZES = [(9.0, 0.3, 20), (8.0, 0.4, 30), (7.0, 0.1, 40)]


def test_the_price_of_a_setting_is_the_parameters_learned_where_it_changes_them(
    tmp_path, monkeypatch
):
    """In seconds the largest would be both the quickest and the best."""
    options = {"path": tmp_path / "sweep.png", "monkeypatch": monkeypatch}
    assert front_lines("method.m.size", SIZES, **options) == [[[20, 0.3], [40, 0.1]]]
    assert front_lines("method.m.size", [(s, emd, 20) for s, emd, _ in SIZES], **options) == [
        [[7.0, 0.1]]
    ]


@pytest.mark.parametrize(
    ("key", "others", "price"),
    [
        ("method.m.size", [(1.0, 0.2, 50)] * 3, "learned parameters"),
        ("method.m.size", [(1.0, 0.2, 0)] * 3, "s a part"),
        ("views.count", [(1.0, 0.2, 50)] * 3, "s a part"),
    ],
)
def test_the_price_is_seconds_where_one_learns_nothing_or_views_change_what_is_learned(
    tmp_path, monkeypatch, key, others, price
):
    options = {"path": tmp_path / "sweep.png", "monkeypatch": monkeypatch}
    assert plot_axes(key, SIZES, others, **options)[-1].get_xlabel() == price


@pytest.mark.parametrize(("most", "scale"), [(3.9, "linear"), (4.1, "log")])
def test_seconds_that_hardly_differ_stand_on_an_axis_with_numbers(
    tmp_path, monkeypatch, most, scale
):
    """Between 1400 and 1430 a logarithmic axis has no tick that is labeled."""
    options = {"path": tmp_path / "sweep.png", "monkeypatch": monkeypatch}
    _, seconds, memory, exchange = plot_axes("views.count", [(1.0, 0.3), (most, 0.1)], **options)
    assert (seconds.get_yscale(), exchange.get_xscale()) == (scale, scale)
    assert (seconds.get_ylim()[0] == 0) == (scale == "linear")
    assert memory.get_yscale() == "linear"  # of which nothing is known


@pytest.fixture(scope="module", params=PUBLISHED, ids=lambda path: path.parent.name)
def published(request):
    """The axes of a published plot, drawn anew: EMD, seconds, memory, and EMD against a price."""
    points, swept = read_published_sweep(request.param.parent)
    series_list, figures = make_series(points, swept), []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "savefig", lambda self, *_, **__: figures.append(self))
        plot_sweep(series_list, fit_trends(series_list, swept[0]), swept[0], Path("sweep.png"))
    figures[0].draw_without_rendering()
    return figures[0].axes


DOT_PX = 4  # from the middle of a dot to its rim


def overlaps(boxes):
    return [pair for pair in combinations(boxes, 2) if pair[0].overlaps(pair[1])]


def line_pixels(axis, line):
    """Pixels on the line, which is straight between its points."""
    pixels = axis.transData.transform(line.get_xydata())
    at = np.linspace(0, len(pixels) - 1, 200)
    return np.stack([np.interp(at, range(len(pixels)), each) for each in pixels.T], axis=1)


def test_no_legend_hides_what_is_drawn(published):
    for axis in published:
        if legend := axis.get_legend():
            box = legend.get_window_extent().padded(DOT_PX)
            assert [
                x for line in axis.lines for x in line_pixels(axis, line) if box.contains(*x)
            ] == []


def test_labels_do_not_run_into_each_other(published):
    for axis in published:
        for ticks in (axis.xaxis, axis.yaxis):
            labels = ticks.get_majorticklabels() + ticks.get_minorticklabels()
            assert overlaps([each.get_window_extent() for each in labels if each.get_text()]) == []
    assert overlaps([text.get_window_extent() for text in published[-1].texts]) == []


@pytest.mark.parametrize("most", [4.1, 9.0, 1e5])
def test_a_logarithmic_axis_has_labels(tmp_path, monkeypatch, most):
    """From 2.1 to 8.6 there is no power of ten."""
    options = {"path": tmp_path / "sweep.png", "monkeypatch": monkeypatch}
    exchange = plot_axes("views.count", [(2.1, 0.3), (2.1 * most, 0.1)], **options)[-1]
    low, high = exchange.get_xlim()
    assert sum(low <= tick <= high for tick in exchange.get_xticks()) >= 2


def test_a_legend_longer_than_its_axis_leaves_half_of_it_to_the_points(tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda self, *_, **__: figures.append(self))
    results = [
        PointResult("m", "dev", 0.1, 0.1, 0.1, None, 1.0, s, None, None, {}) for s in (1.0, 1e3)
    ]
    series_list = [Series(f"m{i}", [1, 2], results) for i in range(20)]
    laws = [
        Trend(each_series.label, "seconds", PowerLaw(1.0, 0.0, 10.0, 2))
        for each_series in series_list
    ]
    plot_sweep(series_list, laws, "views.count", tmp_path / "sweep.png")
    assert figures[0].axes[1].get_ylim()[1] < 1e3 * 1e3**1.2
