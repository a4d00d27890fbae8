"""Render the views of a part: the work of the stage `views`.

Color is linear radiance, straight to 8 bits: no sRGB curve is applied, so a pixel's value is
proportional to the light that it receives, and mixing over an edge is mixing of light.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from industnerf.artifacts.part import Appearance, Mesh, load_mesh, load_part
from industnerf.artifacts.part_warnings import save_part_warnings
from industnerf.artifacts.png import MAX_DEPTH_VALUE
from industnerf.artifacts.views import Views, save_views
from industnerf.capture.backgrounds import Likeness, PartColors, backgrounds, metered_colors
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


@dataclass(frozen=True)
class Scene:
    """A part before its cameras, lit."""

    surface: Surface
    cameras: Cameras  # as they really stand, training views first
    held_out: Bool[np.ndarray, "n"]
    shadings: list[Shading]  # of each view, as are `streams`
    streams: list[RandomStreams]
    center: Float[np.ndarray, "3"]  # of the bounding ball, mm
    radius_mm: float

    @property
    def part_colors(self) -> Iterator[PartColors]:
        """The colors of the part in each view."""
        return metered_colors(self.surface, self.shadings, self.cameras)


def set_up_scene(
    part_id: str, mesh: Mesh, finishes: Sequence[Appearance], settings: ViewsParams, seed: int
) -> Scene:
    """The part `mesh` as `settings` light it and look at it.

    Raises BadParams if it does not fit the field of view.
    """
    center, radius_mm = bounding_ball(mesh.vertices)
    streams = random_streams(seed, part_id, settings)
    rig, held_out = cameras_around(center, radius_mm, settings)
    cameras = jitter_cameras(rig, center, radius_mm, settings, streams)
    surface = Surface(mesh, settings.crease_deg)
    materials = Materials.from_mesh(mesh, finishes, settings.albedo)
    shadings = [view_shading(surface, materials, settings, stream) for stream in streams]
    return Scene(surface, cameras, held_out, shadings, streams, center, radius_mm)


def render_part(source: Path, target: Path, settings: ViewsParams, seed: int) -> None:
    """Write the views of the part in the folder `source` into the folder `target`.

    Raises BadParams if the part does not fit the field of view.
    """
    part, mesh = load_part(source), load_mesh(source)
    scene = set_up_scene(part.part_id, mesh, part.finishes, settings, seed)
    calibration = settings.calibration
    views = Views(
        target,
        part.part_id,
        perturbed_cameras(scene.cameras, scene.held_out, scene.center, calibration, scene.streams),
        scene.held_out,
        backgrounds(settings, scene.streams, scene.part_colors),
        (max_camera_distance(settings) + 1) * scene.radius_mm / MAX_DEPTH_VALUE,
        visible_share(scene.surface, mesh, scene.cameras[~scene.held_out]),
    )
    frames = (
        render_image(scene.surface, shade, K, c2w, background, settings, streams)
        for shade, K, c2w, background, streams in zip(
            scene.shadings,
            scene.cameras.K,
            scene.cameras.c2w,
            views.background,
            scene.streams,
            strict=True,
        )
    )
    likeness = Likeness()
    true_cameras = None if is_exact(calibration) else scene.cameras
    save_views(views, likeness.count(frames, views.background), true_cameras)
    save_part_warnings(target, [likeness.warning])


def background_warning(
    mesh: Mesh, finishes: Sequence[Appearance], settings: ViewsParams, seed: int
) -> str:
    """What `Likeness.warning` says of the colors of `mesh`, before any view is rendered."""
    scene = set_up_scene("", mesh, finishes, settings, seed)
    part_colors = list(scene.part_colors)
    likeness = Likeness()
    for colors, background in zip(
        part_colors, backgrounds(settings, scene.streams, part_colors), strict=True
    ):
        likeness.add(colors, background)
    return likeness.warning


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
