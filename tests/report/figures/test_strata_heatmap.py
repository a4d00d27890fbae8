"""Each stratum of each method is one cell that says its mean."""

from matplotlib.figure import Figure

from industnerf.report.figures import strata_heatmap
from industnerf.report.figures.strata_heatmap import plot_strata
from industnerf.report.tables.strata import ALL, StratumRow


def row(stratum, method, ratio):
    return StratumRow(stratum, method, ratio * 0.01, None, None, 1.0, 0.01, ratio, 2, 1, 0)


def test_a_cell_says_the_mean_of_its_method_and_stratum(monkeypatch):
    figures = []
    monkeypatch.setattr(strata_heatmap, "encode_png", lambda figure: figures.append(figure) or b"")
    rows = [row(ALL, "good", 1.25), row(ALL, "bad", 17.5), row("thin", "bad", 19.0)]
    plot_strata(rows)
    (axis,) = figures[0].axes
    methods = [label.get_text() for label in axis.get_yticklabels()]
    strata = [label.get_text().split()[0] for label in axis.get_xticklabels()]
    cells = {
        (methods[round(y)], strata[round(x)]): text.get_text()
        for text in axis.texts
        for x, y in [text.get_position()]
    }
    assert cells == {("good", ALL): "1.25", ("bad", ALL): "17.50", ("bad", "thin"): "19.00"}
    assert methods == ["good", "bad"]  # the order of the rows, the best first
    assert isinstance(figures[0], Figure)


def test_without_rows_there_is_no_picture():
    assert plot_strata([]) is None
