"""Make the data set of procedural solids: render each by the rig of the study, compute its targets.

Networks are pretrained on it.  It is made from a seed, and nobody downloads it.
"""

from collections.abc import Sequence
from dataclasses import fields, replace
from pathlib import Path

import numpy as np

from industnerf.capture.backgrounds import backgrounds
from industnerf.capture.image_formation import render_image
from industnerf.capture.render import Scene, set_up_scene
from industnerf.geometry.bounding_cube import BoundingCube
from industnerf.geometry.cameras import nested_view_order
from industnerf.learning import targets
from industnerf.learning.procedural_shapes import ProceduralArrays
from industnerf.learning.views import picture_frames
from industnerf.parts.procedural import (
    ALL_KINDS,
    DEFAULT_KINDS,
    RESEMBLING_KINDS,
    ProceduralSolid,
    procedural_solid,
)
from industnerf.schema import ProceduralParams, ViewsParams
from industnerf.seeds import generator

CHUNK = 100  # solids that are made and stored together
POOL = 4096  # points of space whose occupancy is stored
EDGE_SAMPLES = 8  # rays of a pixel on an edge: images this small have many
KINDS = {"abstract": DEFAULT_KINDS, "all": ALL_KINDS}


def chunk_ranges(solids: int) -> dict[str, range]:
    """Which solids each chunk has, by its name."""
    starts = range(0, solids, CHUNK)
    return {f"{start // CHUNK:04d}": range(start, min(start + CHUNK, solids)) for start in starts}


def make_chunk(
    target: Path, *, indices: range, seed: int, settings: ProceduralParams, views: ViewsParams
) -> None:
    """Write the solids `indices` of `seed` into the folder `target`."""
    small = replace(views, held_out=0, resolution=settings.image_px, edge_samples=EDGE_SAMPLES)
    rows, kinds = [], []
    for index in indices:
        solid = procedural_solid(seed, index, KINDS[settings.kinds])
        mesh, finishes = solid.as_mesh()
        scene = set_up_scene(f"procedural {index}", mesh, finishes, small, seed)
        rng = generator(seed, "lessons", str(index))
        rows.append(_row(solid, _few_views(scene, settings.views), small, rng))
        kinds.append(solid.kind)
    names = [field.name for field in fields(ProceduralArrays)]
    resembles = [RESEMBLING_KINDS.get(kind) for kind in kinds]
    arrays = (np.stack(column) for column in zip(*rows, strict=True))
    ProceduralArrays(**dict(zip(names, arrays, strict=True))).save(target, kinds, resembles)


def _few_views(scene: Scene, count: int) -> Scene:
    """The first `count` in nested order."""
    order = nested_view_order(scene.cameras.centers, min(count, len(scene.cameras)))
    return replace(
        scene,
        cameras=scene.cameras[order],
        shadings=[scene.shadings[view] for view in order],
        streams=[scene.streams[view] for view in order],
    )


def _row(
    solid: ProceduralSolid, scene: Scene, settings: ViewsParams, rng: np.random.Generator
) -> Sequence[np.ndarray]:
    """The fields of `ProceduralArrays` of one solid."""
    behind = backgrounds(settings, scene.streams, scene.part_colors)
    images = [
        render_image(scene.surface, shade, K, c2w, background, settings, streams).rgb
        for shade, K, c2w, background, streams in zip(
            scene.shadings,
            scene.cameras.K,
            scene.cameras.c2w,
            behind,
            scene.streams,
            strict=True,
        )
    ]
    pool = targets.sample_occupancy(solid.vertices, solid.faces, POOL, rng)
    surface = targets.surface_points(solid.vertices, solid.faces, targets.SURFACE_POOL, rng)
    return (
        np.stack(images),
        behind.astype(np.float32),
        picture_frames(scene.cameras, BoundingCube.of(solid.vertices)).astype(np.float32),
        targets.filled_shares(solid.vertices, solid.faces, targets.VOXELS),
        pool.points,
        pool.shares,
        surface.astype(np.float16),
    )
