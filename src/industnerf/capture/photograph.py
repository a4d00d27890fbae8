"""Photograph a part: the work of the stage `views`.

Colour is linear radiance, straight to 8 bits: no sRGB curve is applied, so a pixel's value is
proportional to the light that it receives, and mixing over an edge is mixing of light.
"""

from pathlib import Path

from industnerf.artifacts.part import Mesh, load_mesh, load_part
from industnerf.artifacts.png import DEEPEST
from industnerf.artifacts.views import Views, save_views
from industnerf.capture.backdrop import backgrounds
from industnerf.capture.calibration import is_exact, recorded
from industnerf.capture.chance import Draws, draws_of
from industnerf.capture.develop import develop
from industnerf.capture.jitter import farthest, jittered
from industnerf.capture.light import lamps_of
from industnerf.capture.materials import Materials
from industnerf.capture.photo import Photo
from industnerf.capture.rigs import bounding_ball, cameras_around
from industnerf.capture.shading import Matte, Shading
from industnerf.capture.surface import Surface
from industnerf.geometry.cameras import Cameras
from industnerf.geometry.visibility import area_samples, seen_by
from industnerf.schema import ViewsParams


def photograph(source: Path, target: Path, settings: ViewsParams, seed: int) -> None:
    """Write the views of the part in the folder `source` into the folder `target`.

    Raises BadParams if the part does not fit the field of view.
    """
    part, mesh = load_part(source), load_mesh(source)
    centre, radius_mm = bounding_ball(mesh.vertices)
    draws = draws_of(seed, part.part_id, settings)
    rig, held_out = cameras_around(centre, radius_mm, settings)
    cameras = jittered(rig, centre, radius_mm, settings, draws)
    surface = Surface(mesh, settings.crease_deg)
    materials = Materials.of(mesh, part.finishes, settings.albedo)
    views = Views(
        target,
        part.part_id,
        recorded(cameras, held_out, centre, settings.calibration, draws),
        held_out,
        backgrounds(settings, draws),
        (farthest(settings) + 1) * radius_mm / DEEPEST,
        share_seen(surface, mesh, cameras[~held_out]),
    )
    frames = (
        develop(surface, shading(surface, materials, settings, own), K, c2w, behind, settings, own)
        for K, c2w, behind, own in zip(cameras.K, cameras.c2w, views.background, draws, strict=True)
    )
    truth = None if is_exact(settings.calibration) else cameras
    save_views(views, frames, truth)


def shading(surface: Surface, materials: Materials, settings: ViewsParams, draws: Draws) -> Shading:
    """How the part is lit in one view."""
    lamps = lamps_of(settings.light, draws)
    if settings.shading == "photo":
        return Photo(surface, materials, lamps, settings.photo)
    return Matte(materials, lamps)


def share_seen(surface: Surface, mesh: Mesh, cameras: Cameras) -> float:
    """Share of the area that at least one of `cameras` sees, inside its frame."""
    points, tolerance_mm = area_samples(mesh.vertices, mesh.faces)
    return float(seen_by(surface.scene, points, cameras, tolerance_mm).mean())
