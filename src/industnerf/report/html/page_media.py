"""What the page shows of the chosen parts: their clouds, and pictures of them."""

import io
from collections.abc import Sequence
from dataclasses import dataclass, field

from PIL import Image

from industnerf.artifacts.part import Part
from industnerf.report.figures.held_out_renderings import (
    HeldOutRenderings,
    PartImages,
    encode_jpeg,
    load_held_out_renderings,
    load_part_images,
)
from industnerf.report.html.viewer_clouds import ViewerScene, pack_scene
from industnerf.report.study import Study

SHEET_PX = 2600  # of the contact sheet on the page; the file beside it is larger


@dataclass(frozen=True)
class PageMedia:
    """All that the page shows beside numbers."""

    contact_sheet: bytes | None  # JPEG, if there is a part to be shown
    viewer_scenes: Sequence[ViewerScene]
    held_out_renderings: HeldOutRenderings
    pareto_plot: bytes  # PNG: EMD against seconds
    part_images: PartImages = field(default_factory=dict)
    sparsification_plot: bytes | None = (
        None  # PNG: sparsification by confidence, if a method has any
    )


def load_page_media(
    study: Study,
    parts: list[Part],
    contact_sheet: bytes | None,
    pareto_plot: bytes,
    sparsification_plot: bytes | None,
) -> PageMedia:
    """Exhibits of `parts`; `sheet` is their contact sheet, `front` EMD against seconds, all PNG.

    Raises BadArtifact if a file is torn.
    """
    sheet_jpeg = (
        encode_jpeg(Image.open(io.BytesIO(contact_sheet)), SHEET_PX) if contact_sheet else None
    )
    viewer_scenes = [pack_scene(study, part) for part in parts]
    return PageMedia(
        sheet_jpeg,
        viewer_scenes,
        load_held_out_renderings(study, parts),
        pareto_plot,
        load_part_images(study),
        sparsification_plot,
    )
