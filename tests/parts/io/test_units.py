"""Sizes that speak against the unit that was assumed."""

import pytest

from industnerf.parts.io.units import unit_note


def test_a_robot_in_meters_read_as_mm_is_noticed_with_what_it_would_be():
    note = unit_note("mm, assumed", 0.92)
    assert note == (
        "its largest side is 0.92 mm if its numbers are mm, as assumed; "
        "it is 9.2 if cm, 920 if m, 23.37 if inch (parts.units, --units)"
    )


def test_only_units_that_make_the_size_likely_are_offered():
    # 0.04: 0.4 mm if cm and 1.016 mm if inch are as unlikely as 0.04 mm
    assert "; it is 40 if m (" in unit_note("mm, assumed", 0.04)
    # 244 mm that were taken for meters
    assert "are m, as assumed; it is 244 if mm, 2440 if cm (" in unit_note("m, assumed", 244e3)
    assert "are inch, as assumed; it is 244 if mm, 2440 if cm (" in unit_note(
        "inch, assumed", 244 * 25.4
    )


@pytest.mark.parametrize(
    ("unit", "largest_mm"),
    [
        ("mm, stated", 0.92),  # the file says so
        ("mm, assumed", 5.0),
        ("mm, assumed", 5000.0),
        ("mm, assumed", 5e6),  # no unit is smaller
        ("mm, assumed", 1e-4),  # none is large enough
        ("mm, assumed", 0.0),
        ("", 0.0),  # of a file that was refused
    ],
)
def test_likely_stated_and_hopeless_units_have_no_note(unit, largest_mm):
    assert unit_note(unit, largest_mm) == ""
