"""A block with a recess, photographed, and its surface as it is where the recess is plugged."""

import numpy as np
from scipy.ndimage import distance_transform_edt

from industnerf.geometry.cameras import Cameras, look_at, pinhole
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.methods.industnerf_plus.distance_grid import DistanceGrid, redistance
from industnerf.methods.industnerf_plus.finishes import FinishFit
from industnerf.methods.industnerf_plus.lighting import Lighting
from industnerf.methods.industnerf_plus.pictures import Pictures
from industnerf.methods.industnerf_plus.shaded_surface import PinholeRays, ShadedSurface

SIZE, PX = 56, 160
CELL = 2 / SIZE
LO = np.full(3, CELL / 2 - 1)
NODES = np.stack(np.meshgrid(*[np.arange(float(SIZE))] * 3, indexing="ij"), axis=-1)
CENTERED = NODES - (SIZE - 1) / 2
TOP, DEPTH, HALF_WIDTH = 11.3, 9.4, 7.2  # cells
LIGHT = Lighting(0.2, np.array([[0.35, 0.2, 0.3], [-0.25, 0.1, 0.1], [0.0, -0.3, 0.15]]))
VIEWS = Cameras(
    np.repeat(pinhole(30.0, PX)[None], 24, 0),
    look_at(4.0 * fibonacci_sphere(24), np.zeros(3)),
    PX,
    PX,
)
BACKGROUND = np.ones((24, 3))


def box(center: tuple[float, float, float], half: tuple[float, float, float]) -> np.ndarray:
    beyond = np.abs(CENTERED - center) - half
    return np.linalg.norm(np.maximum(beyond, 0), axis=-1) + np.minimum(beyond.max(axis=-1), 0)


BLOCK = box((0, 0, 0), (17.3, 15.3, TOP))
POCKET = box((1.0, 0.5, TOP + 10 - DEPTH), (HALF_WIDTH, HALF_WIDTH, 10))


def surface_of(distance: np.ndarray, finishes: int = 1) -> ShadedSurface:
    """A surface inside the block, under the true light."""
    distance = redistance(distance.astype(np.float32))
    hull = redistance(BLOCK.astype(np.float32))
    surface = ShadedSurface(DistanceGrid(distance, hull, LO, CELL))
    surface.set_finishes(FinishFit(LIGHT, np.ones(finishes), np.zeros(0, np.int64), 0.0, 0.0))
    return surface


def photographs(distance: np.ndarray) -> Pictures:
    """What the cameras see of the true part, in 8 bits."""
    return photographs_of(surface_of(distance))


def photographs_of(truth: ShadedSurface) -> Pictures:
    """What the cameras see of this surface, in 8 bits."""
    truth.update_band(0.1)
    rays = PinholeRays(VIEWS, np.zeros(3), 1.0, truth.grid)
    pixels = np.arange(len(BACKGROUND) * PX * PX, dtype=np.int32)
    rendered = truth.render(rays, pixels, BACKGROUND, 0.1, 0.25)
    rgb = np.rint(np.clip(rendered.color.numpy(), 0, 1) * 255).astype(np.uint8)
    mask = (rendered.hit.numpy() > 0).reshape(-1, PX, PX)
    outlines = [distance_transform_edt(m) - distance_transform_edt(~m) for m in mask]
    return Pictures(rgb.reshape(-1, PX, PX, 3), BACKGROUND, np.array(outlines, np.float32))
