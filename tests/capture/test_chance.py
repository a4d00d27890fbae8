"""Randomness by name: what moves whose numbers."""

from dataclasses import replace

import numpy as np
import pytest

from industnerf.capture.chance import Draws, draws_of, is_random


def numbers(draws: list[Draws], purpose: str) -> list[float]:
    return [each.of(purpose).random() for each in draws]


def test_a_draw_is_the_same_whenever_asked_for():
    draws = Draws(0, "part", "training 0")
    assert draws.of("jitter").random() == draws.of("jitter").random()


def test_seed_part_view_and_purpose_all_matter(settings):
    drawn = [
        each.of(purpose).random()
        for seed in (0, 1)
        for part in ("a", "b")
        for each in draws_of(seed, part, settings)
        for purpose in ("jitter", "noise")
    ]
    assert len(set(drawn)) == len(drawn) == 2 * 2 * 6 * 2


def test_more_views_change_no_others_draws(settings):
    """Training and held-out views are counted apart."""
    few = draws_of(0, "part", settings)
    more = draws_of(0, "part", replace(settings, count=7, held_out=3))
    assert numbers(few[:4], "jitter") == numbers(more[:4], "jitter")
    assert numbers(few[4:], "jitter") == numbers(more[7:9], "jitter")


def test_as_shipped_nothing_is_random(shipped):
    assert not is_random(shipped)


@pytest.mark.parametrize(
    ("section", "knob", "value"),
    [
        (None, "background", "random"),
        ("light", "sway_deg", 1.0),
        ("light", "flicker", 0.1),
        ("jitter", "distance", 0.1),
        ("jitter", "aim", 0.1),
        ("jitter", "roll_deg", 1.0),
        ("jitter", "focal", 0.1),
        ("calibration", "rotation_deg", 1.0),
        ("calibration", "position", 0.1),
        ("calibration", "focal", 0.1),
        ("sensor", "noise", 0.1),
    ],
)
def test_every_random_knob_is_known_as_one(shipped, section, knob, value):
    change = {knob: value}
    if section:
        change = {section: replace(getattr(shipped, section), **change)}
    assert is_random(replace(shipped, **change))


@pytest.mark.parametrize(
    ("section", "knob", "value"),
    [
        (None, "background", "black"),
        (None, "shading", "photo"),
        (None, "rig", "rings"),
        ("sensor", "blur_px", 1.0),
        ("sensor", "jpeg_quality", 50),
    ],
)
def test_other_knobs_are_not(shipped, section, knob, value):
    change = {knob: value}
    if section:
        change = {section: replace(getattr(shipped, section), **change)}
    assert not is_random(replace(shipped, **change))


def test_draws_are_uniform_over_names(shipped):
    """1000 views' first numbers: Kolmogorov's distance beyond 0.08 is chance once in 1e5."""
    drawn = np.sort(numbers(draws_of(0, "part", replace(shipped, count=992)), "light"))
    assert np.abs(drawn - (np.arange(1000) + 0.5) / 1000).max() < 0.08
