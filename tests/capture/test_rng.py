"""Randomness by name: what moves whose numbers."""

from dataclasses import replace

import numpy as np
import pytest

from industnerf.capture.rng import RandomStreams, is_random, random_streams


def draw_each(streams: list[RandomStreams], purpose: str) -> list[float]:
    return [one.generator(purpose).random() for one in streams]


def test_a_draw_is_the_same_whenever_asked_for():
    streams = RandomStreams(0, "part", "training 0")
    assert streams.generator("jitter").random() == streams.generator("jitter").random()


def test_seed_part_view_and_purpose_all_matter(settings):
    values = [
        each.generator(purpose).random()
        for seed in (0, 1)
        for part in ("a", "b")
        for each in random_streams(seed, part, settings)
        for purpose in ("jitter", "noise")
    ]
    assert len(set(values)) == len(values) == 2 * 2 * 6 * 2


def test_more_views_change_no_others_draws(settings):
    """Training and held-out views are counted apart."""
    few = random_streams(0, "part", settings)
    more = random_streams(0, "part", replace(settings, count=7, held_out=3))
    assert draw_each(few[:4], "jitter") == draw_each(more[:4], "jitter")
    assert draw_each(few[4:], "jitter") == draw_each(more[7:9], "jitter")


def test_as_shipped_nothing_is_random(shipped):
    assert not is_random(shipped)


@pytest.mark.parametrize(
    ("section", "knob", "value"),
    [
        (None, "background", "random"),
        ("light", "rotation_jitter_deg", 1.0),
        ("light", "intensity_jitter", 0.1),
        ("jitter", "distance", 0.1),
        ("jitter", "look_at", 0.1),
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
        (None, "shading", "photorealistic"),
        (None, "rig", "turntable"),
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
    values = np.sort(draw_each(random_streams(0, "part", replace(shipped, count=992)), "light"))
    assert np.abs(values - (np.arange(1000) + 0.5) / 1000).max() < 0.08
