"""Photograph a part: the work of the stage `views`.

Colour is linear radiance, straight to 8 bits: no sRGB curve is applied, so a pixel's value is
proportional to the light that it receives, and mixing over an edge is mixing of light.
"""

from pathlib import Path

import numpy as np

from industnerf.artifacts.part import load_mesh, load_part
from industnerf.artifacts.views import Views, save_views
from industnerf.capture.develop import develop
from industnerf.capture.rigs import bounding_ball, cameras_around
from industnerf.capture.surface import Surface
from industnerf.schema import ViewsParams

DEPTH_STEPS = 65535  # largest value of a 16-bit pixel


def photograph(source: Path, target: Path, settings: ViewsParams) -> None:
    """Write the views of the part in the folder `source` into the folder `target`.

    Raises BadParams if the part does not fit the field of view.
    """
    part, mesh = load_part(source), load_mesh(source)
    centre, radius_mm = bounding_ball(mesh.vertices)
    cameras, held_out = cameras_around(centre, radius_mm, settings)
    farthest_mm = (settings.radius + 1) * radius_mm
    views = Views(
        target,
        part.part_id,
        cameras,
        held_out,
        np.array(settings.background, float),
        farthest_mm / DEPTH_STEPS,
    )
    surface = Surface(mesh, settings.crease_deg, settings.light)
    frames = (
        develop(surface, K, c2w, settings) for K, c2w in zip(cameras.K, cameras.c2w, strict=True)
    )
    save_views(views, frames)
