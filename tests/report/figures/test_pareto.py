"""Cost against quality: who is on the front."""

import io
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from industnerf.report.figures import pareto
from industnerf.report.figures.pareto import pareto_front, plot_pareto
from industnerf.report.results import Results
from industnerf.report.tables.costs import CostRow, seconds_and_ratios
from industnerf.report.tables.scores import EMD_EVEN, scores_of, select_scores
from industnerf.report.tables.table1 import table1_rows
from industnerf.report.tables.table1_format import Table1Extra
from industnerf.store import Cost
from tests.report.conftest import SETTINGS

LEVELS = [0.5, 1.0, 2.0, 4.0, 8.0]
POINT_LISTS = st.lists(st.tuples(st.sampled_from(LEVELS), st.sampled_from(LEVELS)), min_size=1)


def brute_force_front(points):
    """By comparing every pair."""
    return sorted(
        {p for p in points if not any(q != p and q[0] <= p[0] and q[1] <= p[1] for q in points)}
    )


@given(POINT_LISTS)
def test_the_front_is_what_nothing_beats_at_both(points):
    assert pareto_front(points) == brute_force_front(points)


def drawn(study, rows, extras, part_points=None):
    """The results of `study` with other rows."""
    results = Results.from_study(study, SETTINGS)
    return replace(results, table1=rows, table1_extras=extras, part_points=part_points or {})


def blue_pixel_count(png):
    red, _, blue = np.moveaxis(np.asarray(Image.open(io.BytesIO(png)).convert("RGB")), 2, 0)
    return int((blue.astype(int) - red > 60).sum())


def test_it_is_drawn_with_the_seconds_that_are_known_and_without_any(study):
    rows = table1_rows(study, SETTINGS)
    blue_pixels = []
    for has_seconds in (True, False):
        extras = [
            Table1Extra(row.emd_even, 10.0**i if has_seconds else None)
            for i, row in enumerate(rows)
        ]
        blue_pixels.append(blue_pixel_count(plot_pareto(drawn(study, rows, extras))))
    assert blue_pixels[0] > 50
    assert blue_pixels[1] == 0


def test_each_part_is_a_dot_at_its_seconds_and_floors(study, monkeypatch):
    figures = []
    monkeypatch.setattr(pareto, "encode_png", lambda figure: figures.append(figure) or b"")
    rows = table1_rows(study, SETTINGS)
    split, first = rows[0].split, rows[0].method
    costs = [
        CostRow(stage, row.method, row.part_id, Cost(9.0, 1.0, "cpu", 0.0, seconds, 0.0))
        for row in scores_of(study, first, split)
        for stage, seconds in (("reconstruct", 2.0), ("evaluate", 7.0))
    ]
    points = seconds_and_ratios(study, costs, split)
    expected = [
        (2.0, row.score.value / row.score.floor)
        for row in select_scores(scores_of(study, first, split), *EMD_EVEN)
    ]
    assert points[first] == expected
    assert not any(points[other] for other in points if other != first)  # of unknown seconds
    plot_pareto(drawn(study, rows, [Table1Extra(None, 2.0) for _ in rows], points))
    lines = figures[0].axes[0].lines
    assert any(line.get_xydata().tolist() == [list(point) for point in expected] for line in lines)


STUDY_2026_11_26 = {  # seconds a part and EMD (even) of the study of 2026-11-26
    "oracle": (0.051, 0.0090),
    "tsdf": (1.303, 0.0102),
    "industnerf_plus": (19.7, 0.0157),
    "carve": (1.916, 0.0176),
    "hull_rgb": (1.664, 0.0212),
    "hull": (1.603, 0.0212),
    "industnerf": (20.2, 0.0222),
    "nerf": (3.8, 0.0281),
    "retrieval": (0.256, 0.0719),
    "r2n2": (0.154, 0.0801),
    "atlasnet": (0.404, 0.0907),
    "box": (0.051, 0.0952),
    "occupancy": (2.590, 0.1036),
    "ball": (0.034, 0.1266),
    "mean_shape": (0.061, 0.1578),
}


@pytest.mark.parametrize(
    "extra_methods", [{}, {"twin": STUDY_2026_11_26["hull"], "third": STUDY_2026_11_26["hull"]}]
)
def test_every_name_can_be_read(study, monkeypatch, extra_methods):
    figures = []
    monkeypatch.setattr(pareto, "encode_png", lambda figure: figures.append(figure) or b"")
    row, has_seconds = table1_rows(study, SETTINGS)[0], STUDY_2026_11_26 | extra_methods
    rows = [
        replace(row, method=name, ratio_to_floor=emd / row.floor)
        for name, (_, emd) in has_seconds.items()
    ]
    extras = [Table1Extra(None, seconds) for seconds, _ in has_seconds.values()]
    plot_pareto(drawn(study, rows, extras))
    figures[0].draw_without_rendering()
    (axis,) = figures[0].axes
    assert {text.get_text() for text in axis.texts} == set(has_seconds)
    boxes = [text.get_window_extent() for text in axis.texts]
    assert [pair for pair in combinations(boxes, 2) if pair[0].overlaps(pair[1])] == []
    assert all(axis.bbox.containsx(x) for box in boxes for x in box.intervalx)
    assert all(axis.bbox.containsy(y) for box in boxes for y in box.intervaly)
