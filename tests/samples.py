"""Small artefacts for tests that need one and do not care what it holds."""

from typing import Any

from industnerf.artifacts.part import UNSPECIFIED, Part


def unit_part(part_id: str = "p1", family: str = "gears", **fields: Any) -> Part:
    """A part of unit size; `facts` are fields of Part that matter."""
    values = {
        "designation": part_id,
        "origin": "embedded",
        "source": "ours",
        "extents_mm": (1.0, 1.0, 1.0),
        "area_mm2": 6.0,
        "volume_mm3": 1.0,
        "bodies": 1,
        "faces": 12,
        "euler_number": 2,
        "visible_share": 1.0,
        "hull_hidden_share": 0.0,
        "strata": (),
        "finishes": (UNSPECIFIED,),
        "defects": (),
    }
    return Part(part_id, family, **(values | fields))
