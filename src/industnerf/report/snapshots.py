"""Held-out photographs beside what each method renders from the same camera, as small JPEGs.

Of a few parts two views each, and of every part the first.
"""

import io
from dataclasses import dataclass

import numpy as np
from jaxtyping import UInt8
from PIL import Image

from industnerf.artifacts.part import Part
from industnerf.artifacts.renderings import FOLDER, Renderings
from industnerf.artifacts.views import load_views
from industnerf.report.gather import Study

SIDE = 160  # px
VIEWS = 2  # of each part
QUALITY = 82


@dataclass(frozen=True)
class Snapshots:
    """For each part and view its photograph, then the answer of each of `methods`."""

    methods: list[str]  # that rendered one of the parts
    rows: list[tuple[Part, list[list[bytes | None]]]]  # JPEG; None where the method failed


def snapshots(study: Study, parts: list[Part]) -> Snapshots:
    """Pictures of every one of `parts`; none if no method renders.

    Raises BadArtifact if a picture is torn.
    """
    methods = [method for method in study.methods if _renders(study, method, parts)]
    return Snapshots(methods, [(p, _pictures(study, p, methods)) for p in parts] if methods else [])


def _renders(study: Study, method: str, parts: list[Part]) -> bool:
    clouds = study.folders.clouds / method
    return any((clouds / part.part_id / FOLDER).is_dir() for part in parts)


def _pictures(study: Study, part: Part, methods: list[str]) -> list[list[bytes | None]]:
    views = load_views(study.folders.views / part.part_id)
    held_out = np.flatnonzero(views.held_out)
    if not len(held_out):
        return []
    chosen = np.unique(np.linspace(0, len(held_out) - 1, VIEWS).round().astype(int))
    photographs = views.rgb(held_out[chosen])
    clouds = [study.folders.clouds / method / part.part_id for method in methods]
    answers = [Renderings.load(cloud) if cloud.is_dir() else None for cloud in clouds]
    return [
        [_small(photograph), *(known and _small(known.rgb[i]) for known in answers)]
        for i, photograph in zip(chosen, photographs, strict=True)
    ]


Album = dict[str, list[tuple[str, bytes]]]  # part id -> what is seen, JPEG


def album(study: Study) -> Album:
    """Of every photographed part its first held-out view, and what methods render from there.

    Raises BadArtifact if a photograph is torn.
    """
    return {name: _first(study, name) for name in study.parts if _photographed(study, name)}


def _photographed(study: Study, part: str) -> bool:
    return (study.folders.views / part).is_dir()


def _first(study: Study, part: str) -> list[tuple[str, bytes]]:
    views = load_views(study.folders.views / part)
    held_out = np.flatnonzero(views.held_out)[:1]
    seen = [("photograph", _small(pixels)) for pixels in views.rgb(held_out)]
    for method in study.methods:
        rendered = study.folders.clouds / method / part / FOLDER / "rgb" / "000.png"
        if seen and rendered.exists():
            with Image.open(rendered) as picture:
                seen.append((method, jpeg(picture)))
    return seen


def _small(pixels: UInt8[np.ndarray, "h w 3"]) -> bytes:
    return jpeg(Image.fromarray(pixels))


def jpeg(image: Image.Image, side: int = SIDE) -> bytes:
    """The picture at most `side` px wide and high."""
    small, file = image.convert("RGB"), io.BytesIO()
    small.thumbnail((side, side), Image.Resampling.LANCZOS)
    small.save(file, "jpeg", quality=QUALITY)
    return file.getvalue()
