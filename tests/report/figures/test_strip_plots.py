"""Strip plots: every part a dot at its place, methods by their medians."""

import re

import pytest

from industnerf.report.figures.strip_plots import LEFT, RIGHT, WIDTH, Dot, Scale, strip_plot
from industnerf.report.html.page import environment

ROWS = {"poor": [Dot("a", 4.0), Dot("b", 8.0, failed=True)], "good": [Dot("a", 1.0)], "none": []}


def draw(*arguments, **options) -> str:
    plot = strip_plot(*arguments, **options)
    return environment().get_template("macros.html.j2").module.strip_plot(plot)


def dot_positions(svg: str) -> dict[str, float]:
    """Where the dot of each title stands."""
    positions = re.findall(r"cx=([\d.]+) .*?<title>(.*?)</title>", svg)
    return {title: float(x) for x, title in positions}


def test_equal_ratios_are_equally_far_apart_on_a_logarithmic_scale():
    scale = Scale.covering([1.0, 8.0], log=True)
    steps = [scale.position(v) for v in (1.0, 2.0, 4.0, 8.0)]
    assert steps[1] - steps[0] == pytest.approx(steps[3] - steps[2], abs=0.2)
    assert LEFT < steps[0] < steps[3] < WIDTH - RIGHT


def test_equal_differences_are_equally_far_apart_on_a_plain_one():
    scale = Scale.covering([-1.0, 0.5], log=False)
    assert scale.position(0.0) - scale.position(-0.5) == pytest.approx(
        scale.position(-0.5) - scale.position(-1.0), abs=0.2
    )


@pytest.mark.parametrize("log", [True, False])
@pytest.mark.parametrize(("low", "high"), [(1.0, 1.0), (0.9, 1.3), (0.01, 70.0)])
def test_a_scale_has_ticks_within_itself(low, high, log):
    scale = Scale.covering([low, high], log=log)
    ticks = scale.ticks()
    assert ticks == sorted(ticks)
    assert all(scale.low <= tick <= scale.high for tick in ticks)
    assert len(ticks) >= (1 if log else 4)


def test_every_part_is_a_dot_that_leads_to_it():
    svg = draw(ROWS, "ratio", log=True, best=1.0)
    positions = dot_positions(svg)
    assert set(positions) == {"a: 4", "b: 8 (failed)", "a: 1"}
    assert positions["a: 1"] < positions["a: 4"] < positions["b: 8 (failed)"]
    assert svg.count("href='#part=a'") == 2
    assert svg.count("class=failed") == 1


def test_methods_stand_by_their_medians_and_one_without_a_part_is_left_out():
    svg = draw(ROWS, "ratio", log=True)
    assert svg.index(">good<") < svg.index(">poor<")
    assert svg.count("none") == 0
    assert strip_plot({"none": []}, "ratio") is None


def test_the_best_value_is_in_sight():
    x = re.search(r"class=zero x1=([\d.]+)", draw({"m": [Dot("a", 5.0)]}, "l", best=0.0))
    assert LEFT <= float(x[1]) <= WIDTH - RIGHT
