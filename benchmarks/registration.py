"""Clouds of dev parts, turned and moved, brought back onto CAD: by us and by other libraries.

small_gicp is asked for where it is installed; it needs a start, and gets one that is 5 degrees and
1 % of the diagonal off.
"""

import time
from importlib.util import find_spec

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

from industnerf.deviation.registration import register
from industnerf.deviation.surface import Surface
from industnerf.geometry.sampling import sample_surface
from industnerf.parts.catalogue.entries import EMBEDDED_FOLDER, load_catalogue_mesh, read_catalogue

PARTS = (
    "gate-valve-dn50-pn16",
    "gantry-plate-c-beam-xl",
    "screw-iso10642-m8x30",
    "gear-ring-m1-5-z60",
    "mounting-rail-en60715-th35",
    "turbine-blade-115",
    "heat-sink-plate-fin-80x60",
    "manifold-iso4401-03-3",
)
POINTS, NOISE = 30_000, 0.002  # noise in diagonals
KINDS = ("clean", "noise", "partial")  # partial: noise, 30 % cut off, 5 % strays


def main() -> None:
    entries = {entry.id: entry for entry in read_catalogue(EMBEDDED_FOLDER)}
    print("| part | cloud | library | median | 95 % | s |\n|---|---|---|---|---|---|")
    for part_id in PARTS:
        mesh = load_catalogue_mesh(entries[part_id])
        surface = Surface(mesh.vertices, mesh.faces)
        for kind in KINDS:
            cloud, exact, pose = make_cloud(surface, kind)
            for library, solve in solvers(surface, cloud, pose).items():
                start = time.process_time()
                matrix = solve()
                seconds = time.process_time() - start
                moved = exact @ matrix[:3, :3].T + matrix[:3, 3]
                off = np.abs(surface.nearest(moved).signed_distance) / surface.diagonal
                print(
                    f"| {part_id} | {kind} | {library} | {np.median(off):.1e} | "
                    f"{np.quantile(off, 0.95):.1e} | {seconds:.1f} |",
                    flush=True,
                )


def make_cloud(surface: Surface, kind: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The cloud, the same without noise and strays, and the pose that both were moved by."""
    rng = np.random.default_rng(1)
    exact = sample_surface(surface.vertices, surface.faces, POINTS, rng)[0]
    cloud = exact + (kind != "clean") * NOISE * surface.diagonal * rng.normal(size=exact.shape)
    if kind == "partial":
        along = cloud @ rng.normal(size=3)
        kept = along > np.quantile(along, 0.3)
        cloud, exact = cloud[kept], exact[kept]
        strays = len(cloud) // 20
        cloud[:strays] = surface.center + 0.4 * surface.diagonal * rng.normal(size=(strays, 3))
    pose = np.eye(4)
    pose[:3, :3] = Rotation.random(rng=rng).as_matrix()
    pose[:3, 3] = surface.diagonal * rng.normal(size=3)
    moved = (points @ pose[:3, :3].T + pose[:3, 3] for points in (cloud, exact))
    return (*moved, pose)


def solvers(surface: Surface, cloud: np.ndarray, pose: np.ndarray) -> dict:
    samples = sample_surface(surface.vertices, surface.faces, POINTS, np.random.default_rng(9))[0]
    found = {
        "ours": lambda: register(cloud, surface, with_scale=False).move.matrix(),
        "trimesh": lambda: by_trimesh(samples, cloud, surface.diagonal),
    }
    if find_spec("small_gicp"):
        found["small_gicp"] = lambda: by_small_gicp(samples, cloud, pose, surface.diagonal)
    return found


def by_trimesh(samples: np.ndarray, cloud: np.ndarray, diagonal: float) -> np.ndarray:
    """Principal axes with every flip, each refined by `trimesh.registration.icp`."""
    few = cloud[np.random.default_rng(0).choice(len(cloud), 1000)]
    axes = [
        np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2]
        for points in (few, samples)
    ]
    best = (np.inf, np.eye(4))
    for signs in np.stack(np.meshgrid([1, -1], [1, -1], [1, -1]), axis=-1).reshape(-1, 3):
        turn = axes[1].T @ np.diag(signs) @ axes[0]
        if np.linalg.det(turn) < 0:
            continue
        start = np.eye(4)
        start[:3, :3], start[:3, 3] = turn, samples.mean(axis=0) - turn @ few.mean(axis=0)
        matrix, _, cost = trimesh.registration.icp(
            few,
            samples,
            initial=start,
            max_iterations=50,
            threshold=1e-9 * diagonal**2,
            scale=False,
            reflection=False,
        )
        best = min(best, (cost, matrix), key=lambda pair: pair[0])
    return best[1]


def by_small_gicp(
    samples: np.ndarray, cloud: np.ndarray, pose: np.ndarray, diagonal: float
) -> np.ndarray:
    import small_gicp

    rng = np.random.default_rng(5)
    off = np.eye(4)
    off[:3, :3] = Rotation.from_rotvec(np.deg2rad(5) * rng.normal(size=3) / 1.7).as_matrix()
    off[:3, 3] = 0.01 * diagonal * rng.normal(size=3) / 1.7
    return small_gicp.align(
        samples,
        cloud,
        off @ np.linalg.inv(pose),
        registration_type="GICP",
        downsampling_resolution=0.005 * diagonal,
        max_correspondence_distance=0.05 * diagonal,
        max_iterations=60,
        rotation_epsilon=1e-6,
        translation_epsilon=1e-6 * diagonal,
    ).T_target_source


if __name__ == "__main__":
    main()
