"""What a reader of clouds hands over: the points of a file, and what else it says of them."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Float64, UInt8

from industnerf.errors import BadPart

MAX_COORDINATE = float(np.finfo(np.float32).max)  # clouds are kept as float32
FAINT = 0.1  # opacity below which a splat is hardly seen


@dataclass(frozen=True)
class CloudContent:
    """The points of a file, in mm where it states a unit and else as they are."""

    points: Float64[np.ndarray, "n 3"]
    warnings: tuple[str, ...] = ()
    colors: UInt8[np.ndarray, "n 3"] | None = None  # sRGB
    confidence: Float[np.ndarray, "n"] | None = None  # as our own files state it, in [0, 1]
    opacity: Float[np.ndarray, "n"] | None = None  # of Gaussian splats, in [0, 1]
    num_faces: int = 0  # of the mesh that the points are drawn of; 0: a cloud
    own_axes: Float64[np.ndarray, "n 3"] | None = None  # before a file's up axis was turned to z

    def select(self, rows: Bool[np.ndarray, "n"]) -> "CloudContent":
        """The points of `rows`, with all that belongs to them."""
        per_point = ("points", "colors", "confidence", "opacity", "own_axes")
        values = {name: getattr(self, name) for name in per_point}
        return replace(
            self, **{name: each[rows] for name, each in values.items() if each is not None}
        )

    def warn(self, *warnings: str) -> "CloudContent":
        """The same with further remarks."""
        return replace(self, warnings=(*self.warnings, *warnings))


def check_points(content: CloudContent) -> CloudContent:
    """`content` without rows that are not finite, which a remark counts.

    Raises BadPart if no point is left, or one is too large for float32.
    """
    points = content.points
    if not len(points):
        raise BadPart("no point in the file")
    finite = np.isfinite(points).all(axis=1)
    if not finite.any():
        raise BadPart(f"none of its {len(points)} points is finite")
    if num_bad := int((~finite).sum()):
        content = content.select(finite).warn(
            f"{num_bad} of its {len(points)} points are not finite and are left out"
        )
    largest = float(np.abs(content.points).max())
    if largest > MAX_COORDINATE:
        num_bad = int((np.abs(content.points) > MAX_COORDINATE).any(axis=1).sum())
        raise BadPart(
            f"{num_bad} of {len(points)} points are too large: a coordinate of {largest:.3g}, and "
            f"float32 ends at {MAX_COORDINATE:.3g}"
        )
    return content


def drop_transparent(content: CloudContent, min_opacity: float) -> CloudContent:
    """Gaussian splats of at least `min_opacity`, with a remark that centers are scored.

    Any other cloud as it is.  Raises BadPart if no splat is left.
    """
    if content.opacity is None:
        return content
    opaque = content.opacity >= min_opacity
    count = len(content.points)
    if not opaque.any():
        raise BadPart(
            f"none of its {count} Gaussian splats has an opacity of {min_opacity:g}: lower "
            "--min-opacity"
        )
    faint = int((content.opacity < FAINT).sum())
    hint = f"; {faint} of them have an opacity below {FAINT}: --min-opacity leaves such out"
    return content.select(opaque).warn(
        f"Gaussian splats: the centers of {int(opaque.sum())} of {count} are taken as points"
        + (hint if not min_opacity and faint else "")
    )
