"""Embree's own C interface, of the library that ships with `embreex`.

Embree uses the widest vectors of the processor, and divides by estimates that AMD and Intel round
differently.  So it is held to AVX2 and asked for faces alone: where a ray meets them is computed in
float64, and of those at nearly the same place the first is taken by that.  So every processor gives
the same bytes.  Numbers, and the order of fields, are those of Embree 4's rtcore.h.
"""

import ctypes
import weakref
from functools import cache
from typing import NoReturn

import numpy as np
from jaxtyping import Float32, Int32

TRIANGLES, INDICES, VERTICES, UINT3, FLOAT3 = 0, 0, 1, 0x5003, 0x9003
ROBUST, FILTER_IN_ARGUMENTS = 1 << 2, 1 << 3  # robust: no ray slips between two faces of a side
INSTRUCTIONS = b"isa=avx2"

RAY = """
    const unsigned none = ~0u;
    struct alignas(16) Ray {
        float origin[3], near, direction[3], time, far;
        unsigned mask, id, flags;
        float normal[3], u, v;
        unsigned face, geometry, instance[2];
    };
    const auto ray_of = [](const float* origin, const float* direction, float far) {
        Ray ray;
        for (int axis = 0; axis < 3; ++axis) {
            ray.origin[axis] = origin[axis];
            ray.direction[axis] = direction[axis];
        }
        ray.near = ray.time = 0;
        ray.far = far;
        ray.mask = ray.face = ray.geometry = ray.instance[0] = ray.instance[1] = ~0u;
        ray.id = ray.flags = 0;
        return ray;
    };
    void* const tree = (void*)scene;
    // Moller and Trumbore (1997): t, u and v of a ray at the three corners of a face
    struct Meeting { double t, u, v; };
    const auto meet = [](const float* corners, const float* from, const float* towards) {
        double a[3], b[3], d[3], s[3];
        for (int axis = 0; axis < 3; ++axis) {
            a[axis] = (double)corners[3 + axis] - corners[axis];
            b[axis] = (double)corners[6 + axis] - corners[axis];
            s[axis] = (double)from[axis] - corners[axis];
            d[axis] = towards[axis];
        }
        const double p[3] = {d[1] * b[2] - d[2] * b[1], d[2] * b[0] - d[0] * b[2],
                             d[0] * b[1] - d[1] * b[0]};
        const double q[3] = {s[1] * a[2] - s[2] * a[1], s[2] * a[0] - s[0] * a[2],
                             s[0] * a[1] - s[1] * a[0]};
        const double area = a[0] * p[0] + a[1] * p[1] + a[2] * p[2];
        return Meeting{(b[0] * q[0] + b[1] * q[1] + b[2] * q[2]) / area,
                       (s[0] * p[0] + s[1] * p[1] + s[2] * p[2]) / area,
                       (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) / area};
    };
    // Calls visitor.visit(visitor, face) for the faces that embree finds along a ray, until true.
    struct Visitor {
        unsigned instance[2];  // as every context of embree begins
        bool (*visit)(Visitor&, unsigned face);
    };
    struct Found {
        int* valid;
        void* user;
        Visitor* visitor;
        unsigned *ray, *hit, lanes;
    };
    const auto visit_faces = [tree](unsigned long long walk, Ray ray, Visitor& visitor) {
        struct {
            unsigned flags, features;
            Visitor* visitor;
            void (*filter)(const Found*);
            void* intersect;
        } every_face = {1u << 1, ~0u, &visitor, nullptr, nullptr};
        every_face.filter = [](const Found* found) {
            if (!found->visitor->visit(*found->visitor, found->hit[5]))
                found->valid[0] = 0;  // on to the next
        };
        visitor.instance[0] = visitor.instance[1] = none;
        ((void (*)(void*, Ray*, void*))walk)(tree, &ray, &every_face);
    };
    // Which ray at which mesh, for visitors that ask where it meets a face.
    struct Line : Visitor {
        const float *corners, *from, *towards;
        decltype(meet) const* solve;
        Meeting at(unsigned face) const { return (*solve)(corners + 9 * face, from, towards); }
        void set(const float* mesh, const float* start, const float* direction,
                 decltype(meet) const& meet) {
            corners = mesh;
            from = start;
            towards = direction;
            solve = &meet;
        }
    };
    // The first of all faces along a ray; of equals that of the lowest number.
    struct Search : Line {
        Meeting best;
        unsigned face;
    };
    const auto first_face = [&](unsigned long long intersect1, const float* corners,
                                const float* from, const float* towards) {
        Search search;
        search.visit = [](Visitor& visitor, unsigned face) {
            Search& search = (Search&)visitor;
            const Meeting met = search.at(face);
            if (met.t < search.best.t || (met.t == search.best.t && face < search.face)) {
                search.best = met;
                search.face = face;
            }
            return false;
        };
        search.face = none;
        search.set(corners, from, towards, meet);
        search.best = {1e37, 0, 0};
        visit_faces(intersect1, ray_of(from, towards, 1e37f), search);
        return search;
    };
"""


class EmbreeTree:
    """Embree's tree over a triangle mesh, and the addresses of the functions that walk it."""

    def __init__(
        self,
        vertices: Float32[np.ndarray, "n 3"],
        faces: Int32[np.ndarray, "m 3"],
    ) -> None:
        embree, device = load_embree()
        self.corners = np.ascontiguousarray(vertices[faces])
        self.intersect1, self.intersect8, self.occluded1 = (
            ctypes.cast(function, ctypes.c_void_p).value
            for function in (embree.rtcIntersect1, embree.rtcIntersect8, embree.rtcOccluded1)
        )
        self.scene = embree.rtcNewScene(device)
        weakref.finalize(self, embree.rtcReleaseScene, self.scene)
        embree.rtcSetSceneFlags(self.scene, ROBUST | FILTER_IN_ARGUMENTS)
        geometry = embree.rtcNewGeometry(device, TRIANGLES)
        for kind, form, values in ((INDICES, UINT3, faces), (VERTICES, FLOAT3, vertices)):
            rows = np.ascontiguousarray(values)  # alive while it is copied from
            buffer = embree.rtcSetNewGeometryBuffer(geometry, kind, 0, form, 12, len(rows))
            if len(rows) and not buffer:
                raise MemoryError(f"embree has no room for {len(rows)} rows of a mesh")
            ctypes.memmove(buffer, rows.ctypes.data, rows.nbytes)
        embree.rtcCommitGeometry(geometry)
        embree.rtcAttachGeometry(self.scene, geometry)
        embree.rtcReleaseGeometry(geometry)
        embree.rtcCommitScene(self.scene)

    def __reduce__(self) -> NoReturn:
        raise TypeError("a tree of embree lives in one process: build it anew from its mesh")


@cache
def load_embree() -> tuple[ctypes.CDLL, int]:
    """The library that a module of `embreex` is linked to, and a device of it."""
    from embreex import rtcore_scene  # an import, so that its version is part of every key

    embree = ctypes.CDLL(rtcore_scene.__file__)
    pointer, number, size = ctypes.c_void_p, ctypes.c_uint, ctypes.c_size_t
    for name, result, *arguments in (
        ("rtcNewDevice", pointer, ctypes.c_char_p),
        ("rtcNewScene", pointer, pointer),
        ("rtcSetSceneFlags", None, pointer, number),
        ("rtcCommitScene", None, pointer),
        ("rtcReleaseScene", None, pointer),
        ("rtcNewGeometry", pointer, pointer, number),
        ("rtcSetNewGeometryBuffer", pointer, pointer, number, number, number, size, size),
        ("rtcCommitGeometry", None, pointer),
        ("rtcAttachGeometry", number, pointer, pointer),
        ("rtcReleaseGeometry", None, pointer),
    ):
        function = getattr(embree, name)
        function.restype, function.argtypes = result, arguments
    device = embree.rtcNewDevice(INSTRUCTIONS)
    if not device:
        raise RuntimeError(f"embree cannot compute with {INSTRUCTIONS.decode()} on this processor")
    return embree, device
