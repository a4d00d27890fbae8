"""All in the colors: a checkered ball, a marbled egg and an animal of colored cubes."""

import numpy as np
from jaxtyping import Bool, Float
from manifold3d import Manifold

from industnerf.artifacts.part import Mesh
from industnerf.parts.catalogue.organic.face_colors import assemble, color_faces
from industnerf.parts.catalogue.organic.forms import Points, plane_wave_noise, union


def ball(edge_mm: float, diameter: float, columns: int, rows: int) -> Mesh:
    """A checkered ball: four colors by the parity of longitude and latitude."""
    mesh = assemble([Manifold.sphere(diameter / 2, round(np.pi * diameter / edge_mm))])

    def east(points: Points) -> Float[np.ndarray, "n"]:
        return np.sin(columns / 2 * np.arctan2(points[:, 1], points[:, 0]))

    def north(points: Points) -> Float[np.ndarray, "n"]:
        latitude = np.arctan2(points[:, 2], np.hypot(points[:, 0], points[:, 1]))
        return np.sin(rows * (latitude + np.pi / 2))

    return color_faces(mesh, [east, north], lambda p: 2 * (north(p) > 0) + (east(p) > 0))


def egg(edge_mm: float, length: float, band: float, colors: int, seed: int) -> Mesh:
    """A ball made narrow by 0.74 (1 - 0.2 z); marble: bands of equal height, bent by noise."""

    def pointed(points: Points) -> Points:
        unit = points / (length / 2)
        narrow = 0.74 * (1 - 0.2 * unit[:, 2])
        return points * np.stack([narrow, narrow, np.ones_like(narrow)], axis=1)

    def marble(points: Points) -> Float[np.ndarray, "n"]:
        return points[:, 2] / band + 1.1 * plane_wave_noise(points, seed, 0.8 * length, 3)

    sphere = Manifold.sphere(length / 2, round(np.pi * length / edge_mm))
    mesh = assemble([sphere.warp_batch(lambda points: pointed(np.array(points)))])
    borders = [lambda p: np.sin(np.pi * marble(p))]
    return color_faces(mesh, borders, lambda p: np.floor(marble(p)).astype(int) % colors)


FOX = (  # color, then from and to of x, y and z, in cubes; later ones paint over earlier ones
    (1, (5, 16), (4, 9), (6, 11)),  # body
    (2, (6, 16), (5, 8), (6, 7)),  # belly
    (3, (6, 8), (4, 6), (0, 6)),  # legs
    (3, (6, 8), (7, 9), (0, 6)),
    (3, (13, 15), (4, 6), (0, 6)),
    (3, (13, 15), (7, 9), (0, 6)),
    (1, (14, 18), (4, 9), (8, 13)),  # neck
    (2, (17, 18), (5, 8), (7, 11)),  # chest
    (1, (16, 22), (3, 10), (11, 17)),  # head
    (2, (20, 22), (3, 10), (11, 13)),  # cheeks
    (1, (22, 25), (5, 8), (12, 14)),  # snout
    (2, (22, 25), (5, 8), (11, 12)),
    (3, (24, 25), (6, 7), (13, 14)),  # nose
    (3, (21, 22), (4, 5), (14, 15)),  # eyes
    (3, (21, 22), (8, 9), (14, 15)),
    (1, (17, 20), (3, 5), (17, 19)),  # ears
    (1, (17, 20), (8, 10), (17, 19)),
    (3, (18, 19), (3, 4), (19, 20)),
    (3, (18, 19), (9, 10), (19, 20)),
    (1, (2, 5), (5, 8), (9, 12)),  # tail
    (1, (0, 4), (4, 9), (11, 17)),
    (2, (0, 4), (4, 9), (17, 19)),
    (2, (1, 3), (5, 8), (19, 21)),
)


def fox(edge_mm: float, cube: float) -> Mesh:
    """An animal of colored cubes; its faces are flat, so `edge_mm` changes nothing."""
    grid = np.zeros((25, 13, 21), np.uint8)
    for color, *spans in FOX:
        grid[tuple(slice(*span) for span in spans)] = color
    return assemble([_cubes(grid == color, cube) for color in (1, 2, 3)])


def _cubes(filled: Bool[np.ndarray, "x y z"], cube: float) -> Manifold:
    one = Manifold.cube((cube, cube, cube))
    return union([one.translate((cube * index).tolist()) for index in np.argwhere(filled)])
