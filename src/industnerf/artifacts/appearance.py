"""What a surface looks like: its color and how it shines."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Appearance:
    """A material as a camera sees it; a face of a mesh names one of its part's finishes."""

    name: str
    albedo: tuple[float, float, float] | None  # linear, in [0, 1]; None: views.albedo decides
    metallic: float  # 0 matte or painted, 1 bare metal; matte shading ignores it
    roughness: float  # 0 mirror, 1 dull; matte shading ignores it


UNSPECIFIED = Appearance("unstated", None, 0.0, 1.0)


def appearance_from_json(row: dict) -> Appearance:
    """The finish that JSON holds as `row`."""
    albedo = row["albedo"]
    return Appearance(**(row | {"albedo": None if albedo is None else tuple(albedo)}))
