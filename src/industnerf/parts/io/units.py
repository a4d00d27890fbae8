"""Units of files, and whether they give a part of a likely size.

STL, OBJ, PLY and OFF state no unit.  Robots are drawn in meters and American parts in inches; read
as mm, they come out smaller than any part is.  Other formats state one, and not all programs write
the right one: glTF is in meters, whatever the numbers in the file are.
"""

MM_PER_UNIT = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "inch": 25.4}  # of parts.units
LIKELY_SIZE_MM = 5.0, 5000.0  # largest side of a part; watches and bridges are elsewhere
POSSIBLE_SIZE_MM = 0.5, 20000.0  # largest side that a stated unit is believed without a warning
ASSUMED, STATED, OVERRIDDEN = ", assumed", ", stated", ", overridden"  # how `Solids.unit` ends
OVERRIDE = "parts.override_units, --override-units"  # the knob


def unit_note(unit: str, largest_mm: float) -> str:
    """What the largest side would be in other units, where the one in use makes it unlikely.

    `unit` is as `Solids` tells it.  Empty if the size is likely, or one that a file that states
    its unit may mean.
    """
    name, _, source = unit.partition(", ")
    low, high = LIKELY_SIZE_MM if source == ASSUMED[2:] else POSSIBLE_SIZE_MM
    if name == "m":  # glTF and COLLADA: many programs write mm, and the format says m
        high = LIKELY_SIZE_MM[1]
    if not source or low <= largest_mm <= high:
        return ""
    size = f"its largest side is {largest_mm:.4g} mm if its numbers are {name}, as {source}"
    numbers = largest_mm / MM_PER_UNIT.get(name, float("nan"))
    likely = [
        f"{numbers * mm:.4g} if {other}"
        for other, mm in MM_PER_UNIT.items()
        if other != name and LIKELY_SIZE_MM[0] <= numbers * mm <= LIKELY_SIZE_MM[1]
    ]
    if not likely:
        return f"{size}, which few parts are"
    knob = "parts.units, --units" if source != STATED[2:] else OVERRIDE
    return f"{size}; it is {', '.join(likely)} ({knob})"
