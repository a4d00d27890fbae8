"""A method for tests alone: it casts rays at the part's own mesh, and returns all there is to."""

from functools import partial
from typing import Any

import numpy as np

from industnerf.artifacts.candidates import Candidates
from industnerf.artifacts.history import History
from industnerf.artifacts.renderings import Renderings
from industnerf.geometry.cameras import Cameras, pixel_centres, project, ray_directions
from industnerf.geometry.raycast import Scene
from industnerf.geometry.sampling import sample_surface
from industnerf.methods.base import Given, Input, Method, Reconstruction, Scope

GREY = 120  # of 255: what the part looks like from everywhere
SPREAD = 0.01  # r.m.s. distance of the candidates, in sizes of the part


def reconstruct(given: Given, settings: Any, state: None, seed: int) -> Reconstruction:
    """The oracle's points, with everything that a method may add."""
    mesh, rng = given.own_mesh, np.random.default_rng(seed)
    points, _ = sample_surface(mesh.vertices, mesh.faces, settings.points, rng)
    off = rng.normal(size=points.shape)
    strayed = points + SPREAD * np.ptp(mesh.vertices, axis=0).max() * off
    sure = np.exp(-np.linalg.norm(off, axis=1)).astype(np.float32)
    return Reconstruction(
        points,
        view=np.arange(len(points)) % len(given.cameras),
        render=partial(render, Scene(mesh.vertices, mesh.faces), given.held_out),
        candidates=Candidates(strayed.astype(np.float32), sure),
        history=History(np.array([0, 5]), np.array([0.2, 0.1]), {"first": 0, "second": 3}),
        steps=6,
    )


def render(scene: Scene, cameras: Cameras) -> Renderings:
    """Grey where a pixel's centre shows the part, white elsewhere."""
    shape = len(cameras), cameras.height, cameras.width
    depth = np.stack([_depth(scene, cameras, i) for i in range(len(cameras))]).reshape(shape)
    hit = depth > 0
    rgb = np.where(hit[..., None], GREY, 255).astype(np.uint8).repeat(3, axis=-1)
    return Renderings(rgb, depth.astype(np.float32), np.where(hit, 255, 0).astype(np.uint8))


def _depth(scene: Scene, cameras: Cameras, view: int) -> np.ndarray:
    K, c2w = cameras.K[view], cameras.c2w[view]
    rays = ray_directions(pixel_centres(cameras.width, cameras.height), K, c2w)
    t = scene.distance(cameras.eyes[view][None], rays)
    hit = np.isfinite(t)
    depth = np.zeros(len(rays))
    depth[hit] = project(cameras.eyes[view] + t[hit, None] * rays[hit], K, c2w)[1]
    return depth


CASTER = Method("caster", Scope.PART, frozenset({Input.OWN_MESH}), reconstruct, random=True)
