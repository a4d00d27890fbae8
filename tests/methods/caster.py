"""A method for tests alone: it casts rays at the part's own mesh, and returns all there is to."""

from functools import partial
from typing import Any

import numpy as np

from industnerf.artifacts.candidates import Candidates
from industnerf.artifacts.history import History
from industnerf.artifacts.renderings import Renderings
from industnerf.geometry.cameras import Cameras, pixel_centers, project, ray_directions
from industnerf.geometry.raycast import RaycastingScene
from industnerf.methods.base import Input, Method, MethodInputs, Reconstruction, Scope
from industnerf.methods.trivial_baselines import reconstruct_oracle

GRAY = 120  # of 255: what the part looks like from everywhere
SPREAD = 0.01  # r.m.s. distance of the candidates, in sizes of the part


def reconstruct(inputs: MethodInputs, settings: Any, state: None, seed: int) -> Reconstruction:
    """The oracle's points, with everything that a method may add."""
    mesh, rng = inputs.own_mesh, np.random.default_rng(seed)
    points = reconstruct_oracle(inputs, settings, state, seed).points_mm
    offsets = rng.normal(size=points.shape)
    candidates = points + SPREAD * np.ptp(mesh.vertices, axis=0).max() * offsets
    confidence = np.exp(-np.linalg.norm(offsets, axis=1)).astype(np.float32)
    return Reconstruction(
        points,
        view=np.arange(len(points)) % len(inputs.cameras),
        render=partial(render, RaycastingScene(mesh.vertices, mesh.faces), inputs.held_out),
        candidates=Candidates(candidates.astype(np.float32), confidence),
        history=History(np.array([0, 5]), np.array([0.2, 0.1]), {"first": 0, "second": 3}),
        steps=6,
    )


def render(scene: RaycastingScene, cameras: Cameras) -> Renderings:
    """Gray where a pixel's center shows the part, white elsewhere."""
    shape = len(cameras), cameras.height, cameras.width
    depth = np.stack([_depth(scene, cameras, i) for i in range(len(cameras))]).reshape(shape)
    hit = depth > 0
    rgb = np.where(hit[..., None], GRAY, 255).astype(np.uint8).repeat(3, axis=-1)
    return Renderings(rgb, depth.astype(np.float32), np.where(hit, 255, 0).astype(np.uint8))


def _depth(scene: RaycastingScene, cameras: Cameras, view: int) -> np.ndarray:
    K, c2w = cameras.K[view], cameras.c2w[view]
    rays = ray_directions(pixel_centers(cameras.width, cameras.height), K, c2w)
    t = scene.distance(cameras.centers[view][None], rays)
    hit = np.isfinite(t)
    depth = np.zeros(len(rays))
    depth[hit] = project(cameras.centers[view] + t[hit, None] * rays[hit], K, c2w)[1]
    return depth


CASTER = Method("caster", Scope.PART, frozenset({Input.OWN_MESH}), reconstruct, is_stochastic=True)
