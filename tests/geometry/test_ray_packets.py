"""Rays in packets of eight against rays cast one by one: the same bits."""

import numpy as np
import pytest
import trimesh

from industnerf.geometry.ray_packets import PacketHits, interpolate
from industnerf.geometry.raycast import RaycastingScene

CAMERA_CENTER = np.array([30.0, -70.0, 55.0])  # mm


def wavy_sheet(steps: int) -> trimesh.Trimesh:
    """A sheet of thin triangles, nearly of one plane two by two; vertices in whole mm."""
    x, y = np.meshgrid(np.arange(steps), np.arange(0, 4 * steps, 4), indexing="ij")
    z = np.rint(3 * np.sin(x / 5.0))
    i = np.arange(steps * steps).reshape(steps, steps)
    quads = np.stack([i[:-1, :-1], i[1:, :-1], i[1:, 1:], i[:-1, 1:]], axis=-1).reshape(-1, 4)
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return trimesh.Trimesh(np.stack([x, y, z], axis=-1).reshape(-1, 3), faces, process=False)


SOLIDS = {
    "box": trimesh.creation.box((20, 30, 40)),
    "ball": trimesh.creation.icosphere(4, 15.0),
    "ring": trimesh.creation.annulus(5, 15, 40, sections=64),
    "sheet": wavy_sheet(30),
}


def single_hits(scene: RaycastingScene, directions: np.ndarray) -> PacketHits:
    hits = scene.cast(CAMERA_CENTER[None], directions)
    ray = np.flatnonzero(hits.face >= 0)
    return PacketHits(ray, hits.t[ray], hits.face[ray], hits.uv[ray])


def scene_of(solid: trimesh.Trimesh) -> RaycastingScene:
    return RaycastingScene(np.array(solid.vertices, float), np.array(solid.faces, np.int32))


def assert_same(packets: PacketHits, single: PacketHits) -> None:
    for found, expected in zip(packets, single, strict=True):
        np.testing.assert_array_equal(found, expected, strict=True)


@pytest.mark.parametrize("name", SOLIDS)
def test_packets_find_what_single_rays_find(name):
    """A grid of rays over the solid, half of which pass it by."""
    solid, size = SOLIDS[name], 61
    scene, center = scene_of(solid), solid.bounds.mean(axis=0)
    right = np.cross(center - CAMERA_CENTER, [0, 0, 1.0])
    right *= np.linalg.norm(solid.extents) / np.linalg.norm(right)
    steps = np.linspace(-0.7, 0.7, size)
    grid = center + steps[:, None, None] * solid.extents[2] * [0, 0, 1.5] + steps[:, None] * right
    directions = (grid.reshape(-1, 3) - CAMERA_CENTER).astype(np.float32)
    hits = scene.cast_from(CAMERA_CENTER, directions)
    assert 0.1 * size**2 < len(hits.ray) < 0.9 * size**2
    assert_same(hits, single_hits(scene, directions))


@pytest.mark.parametrize("name", SOLIDS)
def test_where_faces_tie_packets_choose_as_single_rays_do(name):
    """Rays at points of the sides that faces share: both faces are met, often at equal t."""
    solid, rng = SOLIDS[name], np.random.default_rng(0)
    ends = solid.vertices[solid.edges_unique]
    share = rng.uniform(0, 1, (40, 1, 1))
    points = (ends[:, 0] + share * (ends[:, 1] - ends[:, 0])).reshape(-1, 3)
    directions = (points - CAMERA_CENTER).astype(np.float32)
    scene = scene_of(solid)
    assert_same(scene.cast_from(CAMERA_CENTER, directions), single_hits(scene, directions))


def test_where_bodies_cross_packets_choose_as_single_rays_do():
    """Rays at the curve along which two balls meet, in the middle of their faces."""
    one, two = trimesh.creation.icosphere(3, 15.0), trimesh.creation.icosphere(3, 12.0)
    two.apply_transform(trimesh.transformations.rotation_matrix(0.3, [1, 2, 3]))
    two.apply_translation([9.0, 2, 1])
    segments = trimesh.intersections  # of triangles of one with the planes of the other's
    solid, points = trimesh.util.concatenate([one, two]), []
    for normal, corner in zip(two.face_normals, two.triangles[:, 0], strict=True):
        lines = segments.mesh_plane(one, normal, corner)
        points.append(lines.reshape(-1, 3))
        points.append(lines.mean(axis=1))
    aims = np.concatenate(points)
    aims = aims[np.abs(np.linalg.norm(aims - [9.0, 2, 1], axis=1) - 12) < 0.1]
    directions = (aims - CAMERA_CENTER).astype(np.float32)
    assert len(directions) > 1000
    scene = scene_of(solid)
    assert_same(scene.cast_from(CAMERA_CENTER, directions), single_hits(scene, directions))


@pytest.mark.parametrize("count", [0, 1, 7, 8, 9])
def test_any_number_of_rays_will_do(count):
    solid = SOLIDS["box"]
    directions = np.tile(-CAMERA_CENTER, (count, 1)).astype(np.float32)
    hits = scene_of(solid).cast_from(CAMERA_CENTER, directions)
    np.testing.assert_array_equal(hits.ray, np.arange(count))
    assert hits.uv.shape == (count, 2)
    assert interpolate(hits, np.ones((12, 3, 3), np.float32)).shape == (3, count)


def test_rays_that_miss_are_left_out():
    towards = np.float32(np.arange(24) % 3 != 1)[:, None]
    directions = ((2 * towards - 1) * -CAMERA_CENTER).astype(np.float32)
    hits = scene_of(SOLIDS["box"]).cast_from(CAMERA_CENTER, directions)
    np.testing.assert_array_equal(hits.ray, np.flatnonzero(towards))


def test_vectors_are_interpolated_as_numpy_does():
    rng = np.random.default_rng(0)
    face = rng.integers(0, 50, 1000).astype(np.int32)
    uv, vectors = (rng.normal(size=shape).astype(np.float32) for shape in ((1000, 2), (50, 3, 3)))
    first, along_u, along_v = vectors[face].swapaxes(0, 1)
    expected = (first + uv[:, :1] * along_u + uv[:, 1:] * along_v).T
    hits = PacketHits(np.arange(1000), np.ones(1000, np.float32), face, uv)
    np.testing.assert_array_equal(interpolate(hits, vectors), expected)
