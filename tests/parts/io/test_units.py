"""Sizes that speak against the unit that was assumed."""

import pytest

from industnerf.parts.io.readers import resolve_unit
from industnerf.parts.io.readers.mesh_content import MeshContent
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
        ("mm, stated", 2e4),
        ("m, stated", 5000.0),
        ("mm, overridden", 2e4),
    ],
)
def test_likely_sizes_and_what_a_file_may_mean_have_no_note(unit, largest_mm):
    assert unit_note(unit, largest_mm) == ""


def test_an_absurd_size_is_warninged_upon_whoever_states_the_unit():
    knob = "(parts.override_units, --override-units)"
    assert unit_note("m, stated", 743e3) == (
        f"its largest side is 7.43e+05 mm if its numbers are m, as stated; it is 743 if mm {knob}"
    )
    # mm in glTF, which is in meters by its standard: a pin of 6 mm
    assert "; it is 6 if mm, 60 if cm, 152.4 if inch (parts.o" in unit_note("m, stated", 6e3)
    assert "are mm, as stated; it is 10 if m (parts.o" in unit_note("mm, stated", 0.01)
    assert "; it is 60 if mm, 600 if cm" in unit_note("m, overridden", 6e4)
    assert unit_note("m, overridden", 6e4).endswith("(parts.units, --units)")
    # no unit is smaller, none is large enough, and one is unknown
    for unit, size in (("mm, assumed", 5e6), ("mm, assumed", 1e-4), ("foot, stated", 1e6)):
        assert unit_note(unit, size).endswith(", which few parts are")


def test_a_unit_is_overridden_whose_name_alone_is_right():
    """COLLADA states a name and a factor, which programs let differ."""
    content = MeshContent((), scale=1000.0, unit="cm", is_float32=True)
    assert resolve_unit(content, "cm", override=True) == (10.0, "cm, overridden")
    assert resolve_unit(content, "m", override=True) == (1000.0, "cm, stated")
