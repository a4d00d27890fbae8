"""Render the views of a part: the work of the stage `views`.

Color is linear radiance, straight to 8 bits: no sRGB curve is applied, so a pixel's value is
proportional to the light that it receives, and mixing over an edge is mixing of light.
"""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.part import Mesh, load_mesh, load_part
from industnerf.artifacts.png import MAX_DEPTH_VALUE
from industnerf.artifacts.views import Views, save_views
from industnerf.capture.camera_perturbation import (
    is_exact,
    jitter_cameras,
    max_camera_distance,
    perturbed_cameras,
)
from industnerf.capture.image_formation import render_image
from industnerf.capture.light import view_lights
from industnerf.capture.materials import Materials
from industnerf.capture.pbr_shading import PbrShading
from industnerf.capture.ray_hits import Surface
from industnerf.capture.rigs import bounding_ball, cameras_around
from industnerf.capture.rng import RandomStreams, random_streams
from industnerf.capture.shading import LambertianShading, Shading
from industnerf.geometry.cameras import Cameras
from industnerf.geometry.visibility import area_samples, visible_in
from industnerf.schema import ViewsParams

BACKGROUND_LEVELS = {"white": 255, "gray": 128, "black": 0}


def render_part(source: Path, target: Path, settings: ViewsParams, seed: int) -> None:
    """Write the views of the part in the folder `source` into the folder `target`.

    Raises BadParams if the part does not fit the field of view.
    """
    part, mesh = load_part(source), load_mesh(source)
    center, radius_mm = bounding_ball(mesh.vertices)
    view_streams = random_streams(seed, part.part_id, settings)
    rig, held_out = cameras_around(center, radius_mm, settings)
    cameras = jitter_cameras(rig, center, radius_mm, settings, view_streams)
    surface = Surface(mesh, settings.crease_deg)
    materials = Materials.from_mesh(mesh, part.finishes, settings.albedo)
    views = Views(
        target,
        part.part_id,
        perturbed_cameras(cameras, held_out, center, settings.calibration, view_streams),
        held_out,
        backgrounds(settings, view_streams),
        (max_camera_distance(settings) + 1) * radius_mm / MAX_DEPTH_VALUE,
        visible_share(surface, mesh, cameras[~held_out]),
    )
    frames = (
        render_image(
            surface,
            view_shading(surface, materials, settings, streams),
            K,
            c2w,
            background,
            settings,
            streams,
        )
        for K, c2w, background, streams in zip(
            cameras.K, cameras.c2w, views.background, view_streams, strict=True
        )
    )
    true_cameras = None if is_exact(settings.calibration) else cameras
    save_views(views, frames, true_cameras)


def view_shading(
    surface: Surface, materials: Materials, settings: ViewsParams, streams: RandomStreams
) -> Shading:
    """How the part is lit in one view."""
    lights = view_lights(settings.light, streams)
    if settings.shading == "photorealistic":
        return PbrShading(surface, materials, lights, settings.photorealistic)
    return LambertianShading(materials, lights)


def visible_share(surface: Surface, mesh: Mesh, cameras: Cameras) -> float:
    """Share of the area that at least one of `cameras` sees, inside its frame."""
    points, tolerance_mm = area_samples(mesh.vertices, mesh.faces)
    return float(visible_in(surface.scene, points, cameras, tolerance_mm).mean())


def backgrounds(
    settings: ViewsParams, view_streams: list[RandomStreams]
) -> Float[np.ndarray, "n 3"]:
    """The background of each view, in [0, 1].

    All are multiples of 1/255, so that a picture without noise shows them exactly.
    """
    if settings.background == "random":
        colors = [streams.generator("background").integers(0, 256, 3) for streams in view_streams]
        return np.array(colors) / 255
    return np.full((len(view_streams), 3), BACKGROUND_LEVELS[settings.background] / 255)
