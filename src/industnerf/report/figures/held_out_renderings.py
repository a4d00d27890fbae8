"""Held-out images beside what each method renders from the same camera, as small JPEGs.

Two views of the parts in the viewer, and the first view of every part.
"""

import io
from dataclasses import dataclass

import numpy as np
from jaxtyping import UInt8
from PIL import Image

from industnerf.artifacts.part import Part
from industnerf.artifacts.renderings import ARCHIVE, Renderings
from industnerf.artifacts.views import load_views
from industnerf.report.study import Study

MAX_SIDE_PX = 160
VIEWS = 2  # of each part
QUALITY = 82


@dataclass(frozen=True)
class HeldOutRenderings:
    """For each part and view its image, then the rendering of each of `methods`."""

    methods: list[str]  # that rendered one of the parts
    rows: list[tuple[Part, list[list[bytes | None]]]]  # JPEG; None where the method failed


def load_held_out_renderings(study: Study, parts: list[Part]) -> HeldOutRenderings:
    """Images and renderings of `parts`; empty if no method renders.

    Raises BadArtifact if a file is torn.
    """
    methods = [method for method in study.methods if _has_renderings(study, method, parts)]
    return HeldOutRenderings(
        methods, [(p, _view_images(study, p, methods)) for p in parts] if methods else []
    )


def _has_renderings(study: Study, method: str, parts: list[Part]) -> bool:
    clouds = study.folders.clouds / method
    return any((clouds / part.part_id / ARCHIVE).exists() for part in parts)


def _view_images(study: Study, part: Part, methods: list[str]) -> list[list[bytes | None]]:
    views = load_views(study.folders.views / part.part_id)
    held_out = np.flatnonzero(views.held_out)
    if not len(held_out):
        return []
    indices = np.unique(np.linspace(0, len(held_out) - 1, VIEWS).round().astype(int))
    images = views.rgb(held_out[indices])
    clouds = [study.folders.clouds / method / part.part_id for method in methods]
    renderings = [Renderings.load(cloud) if cloud.is_dir() else None for cloud in clouds]
    return [
        [
            _encode_pixels(image),
            *(rendering and _encode_pixels(rendering.rgb[i]) for rendering in renderings),
        ]
        for i, image in zip(indices, images, strict=True)
    ]


PartImages = dict[str, list[tuple[str, bytes]]]  # part id -> what is seen, JPEG


def load_part_images(study: Study) -> PartImages:
    """The first held-out view of every part that has views, and what methods render from there.

    Raises BadArtifact if an image is torn.
    """
    return {
        name: _first_held_out_images(study, name) for name in study.parts if _has_views(study, name)
    }


def _has_views(study: Study, part: str) -> bool:
    return (study.folders.views / part).is_dir()


def _first_held_out_images(study: Study, part: str) -> list[tuple[str, bytes]]:
    views = load_views(study.folders.views / part)
    held_out = np.flatnonzero(views.held_out)[:1]
    images = [("image", _encode_pixels(pixels)) for pixels in views.rgb(held_out)]
    for method in study.methods:
        rendered = Renderings.load_first_rgb(study.folders.clouds / method / part)
        if images and rendered is not None:
            images.append((method, _encode_pixels(rendered)))
    return images


def _encode_pixels(pixels: UInt8[np.ndarray, "h w 3"]) -> bytes:
    return encode_jpeg(Image.fromarray(pixels))


def encode_jpeg(image: Image.Image, max_side_px: int = MAX_SIDE_PX) -> bytes:
    """`image` as JPEG, at most `max_side_px` wide and high."""
    resized, buffer = image.convert("RGB"), io.BytesIO()
    resized.thumbnail((max_side_px, max_side_px), Image.Resampling.LANCZOS)
    resized.save(buffer, "jpeg", quality=QUALITY)
    return buffer.getvalue()
