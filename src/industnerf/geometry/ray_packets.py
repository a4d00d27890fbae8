"""Rays from one point, cast eight at a time: embree's answers in less than half the time.

Neighboring rays meet the same boxes of embree's tree, so a packet walks it once for all eight.
What may differ from single rays is which boxes a ray enters, and so two kinds of hit are cast
again, singly:

- next to a face's side: a single ray may miss the face's box by a rounding, or take the face
  beyond the side, where t is nearly equal;
- on a face that crosses another, where t may be equal on both.

Of faces that lie in each other, all of which a ray meets at once, a packet may choose another one.
"""

from typing import NamedTuple, no_type_check  # compiled, not called: nothing to check

import numpy as np
import warp as wp
from jaxtyping import Float32, Int, Int32

from industnerf.geometry.crossing_faces import crossing_faces
from industnerf.geometry.embree_tree import RAY, EmbreeTree
from industnerf.geometry.warp_runtime import init_warp, on_cpu

init_warp()
# unfused: products are rounded as numpy rounds them
wp.set_module_options({"enable_backward": False, "fuse_fp": False})

# Distance from a side, across the ray, in sizes of the mesh.  Some size 1 away roundings move a
# ray by 1e-6; hits that differ were seen in a thousand million rays, all nearer than 3e-6.
SIDE_BAND = 1e-5


class PacketHits(NamedTuple):
    """First intersections of those rays that meet the mesh, in the order of the rays."""

    ray: Int[np.ndarray, "hits"]  # which rays
    t: Float32[np.ndarray, "hits"]  # in lengths of their directions
    face: Int32[np.ndarray, "hits"]
    uv: Float32[np.ndarray, "hits 2"]  # barycentric weights of the face's 2nd and 3rd corner


CAST_PACKETS = (
    RAY
    + """
    struct alignas(32) Packet {
        float origin[3][8], near[8], direction[3][8], time[8], far[8];
        unsigned mask[8], id[8], flags[8];
        float normal[3][8], u[8], v[8];
        unsigned face[8], geometry[8], instance[2][8];
    };
    struct { unsigned flags, features; void *context, *filter, *intersect; } coherent = {
        1u << 16, none, nullptr, nullptr, nullptr
    };
    auto* const cast_eight = (void (*)(const int*, void*, Packet*, void*))intersect8;
    const float far = 1e37f;
    int found = 0;
    for (int first = 0; first < rays; first += 8) {
        alignas(32) int valid[8];
        Packet packet;
        for (int k = 0; k < 8; ++k) {
            const int ray = first + k < rays ? first + k : rays - 1;
            valid[k] = first + k < rays ? -1 : 0;
            for (int axis = 0; axis < 3; ++axis) {
                packet.origin[axis][k] = origin.data[axis];
                packet.direction[axis][k] = directions.data[3 * ray + axis];
            }
            packet.near[k] = packet.time[k] = 0;
            packet.far[k] = far;
            packet.mask[k] = packet.face[k] = packet.geometry[k] = none;
            packet.instance[0][k] = packet.instance[1][k] = none;
            packet.id[k] = packet.flags[k] = 0;
        }
        cast_eight(valid, tree, &packet, &coherent);
        for (int k = 0; k < 8 && first + k < rays; ++k) {
            unsigned hit_face = packet.face[k];
            if (hit_face == none) continue;
            const float* towards = directions.data + 3 * (first + k);
            Meeting met = meet(corners.data + 9 * hit_face, origin.data, towards);
            float area = 0, length = 0;  // twice the area that the ray sees, times its length
            for (int axis = 0; axis < 3; ++axis) {
                area += packet.normal[axis][k] * packet.direction[axis][k];
                length += packet.direction[axis][k] * packet.direction[axis][k];
            }
            length = sqrtf(length);
            const double w = 1 - met.u - met.v;
            const double least = met.u < met.v ? (met.u < w ? met.u : w) : (met.v < w ? met.v : w);
            if (!(least * fabsf(area) >= band.data[hit_face] * length)) {
                const Search search =
                    first_face(intersect1, corners.data, origin.data, towards);
                hit_face = search.face;
                if (hit_face == none) continue;
                met = search.best;
            }
            ids.data[found] = first + k;
            t.data[found] = (float)met.t * scale;
            face.data[found] = hit_face;
            uv.data[2 * found] = (float)met.u;
            uv.data[2 * found + 1] = (float)met.v;
            ++found;
        }
    }
    count.data[0] = found;
"""
)


@wp.func_native(CAST_PACKETS)
@no_type_check
def cast_packets(
    intersect1: wp.uint64,
    intersect8: wp.uint64,
    scene: wp.uint64,
    band: wp.array(dtype=wp.float32),
    corners: wp.array(dtype=wp.float32),
    origin: wp.array(dtype=wp.float32),
    directions: wp.array(dtype=wp.float32),
    rays: wp.int32,
    scale: wp.float32,
    ids: wp.array(dtype=wp.int64),
    t: wp.array(dtype=wp.float32),
    face: wp.array(dtype=wp.int32),
    uv: wp.array(dtype=wp.float32),
    count: wp.array(dtype=wp.int32),
): ...


@wp.kernel
@no_type_check
def cast_all_packets(
    intersect1: wp.uint64,
    intersect8: wp.uint64,
    scene: wp.uint64,
    band: wp.array(dtype=wp.float32),
    corners: wp.array(dtype=wp.float32),
    origin: wp.array(dtype=wp.float32),
    directions: wp.array(dtype=wp.float32),
    rays: wp.int32,
    scale: wp.float32,
    ids: wp.array(dtype=wp.int64),
    t: wp.array(dtype=wp.float32),
    face: wp.array(dtype=wp.int32),
    uv: wp.array(dtype=wp.float32),
    count: wp.array(dtype=wp.int32),
):
    """One thread: hits keep the order of the rays."""
    cast_packets(
        intersect1, intersect8, scene, band, corners, origin, directions, rays, scale,
        ids, t, face, uv, count,
    )  # fmt: skip


@wp.kernel
@no_type_check
def interpolate_all(
    face: wp.array(dtype=wp.int32),
    uv: wp.array(dtype=wp.float32),
    corner_vectors: wp.array(dtype=wp.float32),
    hits: wp.int32,
    vectors: wp.array(dtype=wp.float32),
):
    """One thread a hit."""
    hit = wp.tid()
    first = 9 * face[hit]
    for axis in range(3):
        along_u = uv[2 * hit] * corner_vectors[first + 3 + axis]
        along_v = uv[2 * hit + 1] * corner_vectors[first + 6 + axis]
        vectors[axis * hits + hit] = corner_vectors[first + axis] + along_u + along_v


def interpolate(
    hits: PacketHits, corner_vectors: Float32[np.ndarray, "m 3 3"]
) -> Float32[np.ndarray, "3 hits"]:
    """The vectors at `hits`: linear over each of `m` faces.

    `corner_vectors` has a face's vector at its first corner and the differences to the others'.
    """
    count = len(hits.face)
    vectors = np.empty((3, count), np.float32)
    inputs = [on_cpu(x) for x in (hits.face, hits.uv, corner_vectors)]
    wp.launch(interpolate_all, count, [*inputs, count], [on_cpu(vectors)], device="cpu")
    return vectors


class PacketScene:
    """A tree over a mesh in the unit box that packets of rays can be cast at."""

    def __init__(self, tree: EmbreeTree) -> None:
        self._tree, corners = tree, tree.corners
        longest_side = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        self._band = np.float32(SIDE_BAND) * longest_side
        self._band[crossing_faces(self._tree, corners)] = np.inf

    def cast(
        self,
        origin: Float32[np.ndarray, "3"],
        directions: Float32[np.ndarray, "rays 3"],
        scale: float,
    ) -> PacketHits:
        """Where the rays from `origin` first meet the mesh; t is multiplied by `scale`."""
        rays, tree = len(directions), self._tree
        ids, t, face = (np.empty(rays, x) for x in (np.int64, np.float32, np.int32))
        uv, count = np.empty((rays, 2), np.float32), np.zeros(1, np.int32)
        arrays = [on_cpu(x) for x in (self._band, tree.corners, origin, directions)]
        inputs = [tree.intersect1, tree.intersect8, tree.scene, *arrays, rays, scale]
        outputs = [on_cpu(x) for x in (ids, t, face, uv, count)]
        wp.launch(cast_all_packets, 1, inputs, outputs, device="cpu")
        hits = int(count[0])
        return PacketHits(ids[:hits], t[:hits], face[:hits], uv[:hits])
