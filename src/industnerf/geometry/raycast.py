"""Ray casting at a triangle mesh, by embree."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float, Float32, Int32

from industnerf.geometry.embree_tree import EmbreeTree
from industnerf.geometry.sphere import fibonacci_sphere

if TYPE_CHECKING:  # warp takes a second
    from industnerf.geometry.ray_packets import PacketHits, PacketScene


@dataclass(frozen=True)
class Hits:
    """First intersections, one per ray; a ray that misses has face -1 and t = inf."""

    t: Float32[np.ndarray, "rays"]  # lengths of `directions`: mm if they are unit vectors
    face: Int32[np.ndarray, "rays"]
    uv: Float32[np.ndarray, "rays 2"]  # barycentric weights of the face's 2nd and 3rd corner


class RaycastingScene:
    """A triangle mesh that rays can be cast at.

    Embree computes in float32, so the mesh is moved and scaled into the unit box first: a part
    far from the origin loses no digits.  Results agree with float64 to about 1e-6 of the size.
    """

    def __init__(self, vertices: Float[np.ndarray, "n 3"], faces: Int32[np.ndarray, "m 3"]) -> None:
        self._origin = vertices.min(axis=0)
        self._size = max(float(np.ptp(vertices, axis=0).max()), 1e-30)
        self._tree = EmbreeTree(self._to_box(vertices), np.ascontiguousarray(faces, np.int32))

    def _to_box(self, points: Float[np.ndarray, "n 3"]) -> Float32[np.ndarray, "n 3"]:
        return ((points - self._origin) / self._size).astype(np.float32)

    def cast(
        self, origins: Float[np.ndarray, "#rays 3"], directions: Float[np.ndarray, "rays 3"]
    ) -> Hits:
        """Where the rays from `origins` (mm; one for all, or one each) first meet the mesh.

        `directions` may have any length; `t` counts in it.
        """
        from industnerf.geometry.single_rays import cast_singly

        t, face, uv = cast_singly(self._tree, *self._rays(origins, directions))
        t[face < 0] = np.inf
        t *= np.float32(self._size)
        return Hits(t, face, uv)

    def _rays(self, origins: Float[np.ndarray, "_ 3"], directions: Float[np.ndarray, "rays 3"]):
        """Origins in the box and directions, both float32 and one for each ray."""
        starts = np.empty(directions.shape, np.float32)
        starts[:] = self._to_box(origins)
        return starts, np.ascontiguousarray(directions, np.float32)

    def cast_from(
        self, origin: Float[np.ndarray, "3"], directions: Float32[np.ndarray, "rays 3"]
    ) -> "PacketHits":
        """What `cast` finds, of the rays that hit, in less than half the time.

        Rays that follow each other should be neighbors: they are cast eight at a time.  Of faces
        that lie in each other another one may be found.
        """
        towards = np.ascontiguousarray(directions, np.float32)
        return self._packets.cast(self._to_box(origin[None])[0], towards, self._size)

    @cached_property
    def _packets(self) -> "PacketScene":
        from industnerf.geometry.ray_packets import PacketScene

        return PacketScene(self._tree)

    def distance(
        self, origins: Float[np.ndarray, "#rays 3"], directions: Float[np.ndarray, "rays 3"]
    ) -> Float32[np.ndarray, "rays"]:
        """`cast(...).t` alone."""
        return self.cast(origins, directions).t

    def is_occluded(
        self,
        origins: Float[np.ndarray, "#rays 3"],
        directions: Float[np.ndarray, "rays 3"],
        within: Float[np.ndarray, "#rays"] | float = np.inf,
    ) -> Bool[np.ndarray, "rays"]:
        """Whether the rays from `origins` (mm) meet the mesh at a t below `within`.

        Cheaper than where: a ray ends at the first such face that is found, wherever it lies.
        """
        from industnerf.geometry.single_rays import are_occluded

        ends = np.empty(len(directions))
        ends[:] = np.asarray(within) / self._size
        return are_occluded(self._tree, *self._rays(origins, directions), ends)


def parallel_ray_bundles(
    vertices: Float[np.ndarray, "n 3"], views: int, rays_across: int
) -> Iterator[tuple[Float[np.ndarray, "rays 3"], Float[np.ndarray, "3"]]]:
    """`views` bundles of parallel rays at a mesh, from all round.

    Each is a square grid of `rays_across`**2 origins (mm) and one unit direction.

    Every bundle is as wide as the bounding box's diagonal and starts outside the box.
    """
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    radius = 0.5 * float(np.linalg.norm(high - low))
    offsets = radius * (2 * np.arange(rays_across) + 1 - rays_across) / rays_across
    grid = np.stack(np.meshgrid(offsets, offsets), axis=-1).reshape(-1, 2)
    for direction in fibonacci_sphere(views):
        plane_axes = np.linalg.svd(direction[None])[2][1:]  # two unit vectors across the bundle
        yield (low + high) / 2 - 2 * radius * direction + grid @ plane_axes, direction
