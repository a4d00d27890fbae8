"""What the page shows of the chosen parts: their clouds, and pictures of them."""

import io
from collections.abc import Sequence
from dataclasses import dataclass, field

from PIL import Image

from industnerf.artifacts.part import Part
from industnerf.report.gather import Study
from industnerf.report.scenes import Scene, scene
from industnerf.report.snapshots import Album, Snapshots, album, jpeg, snapshots

SHEET_PX = 2600  # of the contact sheet on the page; the file beside it is larger


@dataclass(frozen=True)
class Exhibits:
    """All that the page shows beside numbers."""

    sheet: bytes | None  # JPEG, if there is a part to be shown
    scenes: Sequence[Scene]
    snapshots: Snapshots
    front: bytes  # PNG: EMD against seconds
    album: Album = field(default_factory=dict)
    curves: bytes | None = None  # PNG: sparsification by confidence, if a method has any


def exhibits(
    study: Study, parts: list[Part], sheet: bytes | None, front: bytes, curves: bytes | None
) -> Exhibits:
    """Exhibits of `parts`; `sheet` is their contact sheet, `front` EMD against seconds, all PNG.

    Raises BadArtifact if a file is torn.
    """
    small = jpeg(Image.open(io.BytesIO(sheet)), SHEET_PX) if sheet else None
    scenes = [scene(study, part) for part in parts]
    return Exhibits(small, scenes, snapshots(study, parts), front, album(study), curves)
