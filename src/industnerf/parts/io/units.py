"""Units of files, and whether one that was assumed gives a part of a likely size.

STL, OBJ, PLY and OFF state no unit.  Robots are drawn in meters and American parts in inches; read
as mm, they come out smaller than any part is.
"""

MM_PER_UNIT = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "inch": 25.4}  # of parts.units
LIKELY_SIZE_MM = 5.0, 5000.0  # largest side of a part; watches and bridges are elsewhere


def unit_note(unit: str, largest_mm: float) -> str:
    """What the largest side would be in other units, where the assumed one makes it unlikely.

    `unit` is as `Solids` tells it.  Empty if the file states its unit, or the size is likely, or
    no other unit would make it so.
    """
    name, assumed, _ = unit.partition(", assumed")
    if not assumed or _is_likely(largest_mm):
        return ""
    sizes = {other: largest_mm * mm / MM_PER_UNIT[name] for other, mm in MM_PER_UNIT.items()}
    likely = [f"{size:.4g} if {other}" for other, size in sizes.items() if _is_likely(size)]
    if not likely:
        return ""
    return (
        f"its largest side is {largest_mm:.4g} mm if its numbers are {name}, as assumed; "
        f"it is {', '.join(likely)} (parts.units, --units)"
    )


def _is_likely(size_mm: float) -> bool:
    return LIKELY_SIZE_MM[0] <= size_mm <= LIKELY_SIZE_MM[1]
