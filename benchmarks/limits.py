"""Where does the error lie: on what many photographs show, or on what hardly one does?

OMP_NUM_THREADS=1 python benchmarks/limits.py DATA [--methods ...] [--split dev]

DATA is the folder `data` of a finished run, of which `parts`, `views`, `truth`, `clouds` and
`split.json` are read.  The EMD (P1-even) is the mean over points of the true surface of how far
each is carried.  These points are told apart by how many training cameras see them:

    share      of the points, mean over parts
    carried    how far a point of the group is carried, in floors of its part
    part       of the EMD, in floors: what the group adds to it
    excess     the same, less what it adds for a second sample of the true surface

Groups add up to the last line.
"""

import argparse
from collections import defaultdict
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import ot
from jaxtyping import Float, Int
from rich.console import Console
from rich.progress import track
from rich.table import Table
from scipy.spatial.distance import cdist

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.split import load_split
from industnerf.artifacts.truth import Truth
from industnerf.artifacts.views import load_views
from industnerf.config import load_params
from industnerf.geometry.raycast import RaycastingScene
from industnerf.geometry.visibility import visible_from
from industnerf.metrics.protocol import Evaluator
from industnerf.metrics.reference_rig import SURFACE_TOLERANCE
from industnerf.metrics.subsample import farthest_points
from industnerf.seeds import generator

METHODS = ["industnerf_plus", "industnerf", "hull", "oracle"]
ORACLE = "oracle"  # what is left over of it is no method's fault
GROUPS = {"at most 1": (0, 1), "2 to 3": (2, 3), "4 to 7": (4, 7), "8 or more": (8, np.inf)}
ALL_POINTS = "all"


@dataclass(frozen=True)
class VisibilityGroup:
    """Points of one part that about as many cameras see."""

    share: float
    emd_contribution: float  # floors


def groups_of(data: Path, part_id: str, method: str) -> dict[str, VisibilityGroup]:
    """How far the true surface of one part is from a cloud, group by group."""
    params, part = load_params(), data / "parts" / part_id
    evaluator = Evaluator(part, Truth.load(data / "truth" / part_id), params.evaluate, params.seed)
    cloud = Cloud.load(data / "clouds" / method / part_id).points_mm
    sampled = evaluator.sample_prediction(cloud, generator(params.seed, "evaluate", part_id))
    truth, count = evaluator.truth, params.evaluate.points
    truth = farthest_points(truth.points[truth.evaluated], count)
    transport_distances = transport_distances_of(
        farthest_points(sampled.points[sampled.evaluated], count), truth
    )
    transport_distances /= evaluator.ground_truth.floors["emd P1-even"].value
    num_cameras = count_cameras(evaluator, truth, data / "views" / part_id)
    groups = {ALL_POINTS: VisibilityGroup(1.0, transport_distances.mean())}
    for name, (least, most) in GROUPS.items():
        of_group = (num_cameras >= least) & (num_cameras <= most)
        groups[name] = VisibilityGroup(
            of_group.mean(), transport_distances[of_group].sum() / len(truth)
        )
    return groups


def transport_distances_of(
    cloud: Float[np.ndarray, "n 3"], truth: Float[np.ndarray, "m 3"]
) -> Float[np.ndarray, "m"]:
    """How far each point of the truth is from what is carried onto it; the mean is the EMD."""
    cost = cdist(cloud, truth)
    masses = (np.full(size, 1 / size) for size in cost.shape)
    plan, log = ot.emd(*masses, cost, numItermax=10**8, log=True)
    if log["warning"]:
        raise RuntimeError(f"POT did not solve it: {log['warning']}")
    return (plan * cost).sum(axis=0) * len(truth)


def count_cameras(
    evaluator: Evaluator, truth: Float[np.ndarray, "m 3"], views: Path
) -> Int[np.ndarray, "m"]:
    """How many training cameras see each point, given in diagonals."""
    capture, part_frame = load_views(views), evaluator.reference
    scene = RaycastingScene(part_frame.mesh.vertices, part_frame.mesh.faces)
    points = truth * part_frame.diagonal_mm + part_frame.center
    tolerance_mm = SURFACE_TOLERANCE * part_frame.diagonal_mm
    camera_centers = capture.cameras[capture.train_indices].centers
    return sum(
        visible_from(scene, points, camera_center[None], tolerance_mm).astype(int)
        for camera_center in camera_centers
    )


def mean_groups(parts: list[dict[str, VisibilityGroup]]) -> dict[str, tuple[float, float]]:
    """Share and floors added, mean over parts, group by group."""
    gathered = defaultdict(list)
    for part in parts:
        for name, group in part.items():
            gathered[name].append((group.share, group.emd_contribution))
    return {name: tuple(np.mean(values, axis=0)) for name, values in gathered.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("data", type=Path)
    parser.add_argument("--methods", nargs="+", default=METHODS)
    parser.add_argument("--split", default="dev")
    arguments = parser.parse_args()
    split = load_split(arguments.data / "split.json")
    part_ids = [
        part_id for part_id, assignment in split.items() if assignment.split == arguments.split
    ]
    table = Table(title=f"{len(part_ids)} {arguments.split} parts, floors")
    for head in ("method", "seen by", "share", "carried", "part", "excess"):
        table.add_column(head, justify="left" if head in ("method", "seen by") else "right")
    results = {}
    with ProcessPoolExecutor() as pool:
        for method in dict.fromkeys([*arguments.methods, ORACLE]):
            work = pool.map(partial(groups_of, arguments.data, method=method), part_ids)
            results[method] = mean_groups(list(track(work, method, len(part_ids))))
    for method in arguments.methods:
        for name in (*GROUPS, ALL_POINTS):
            (share, contribution) = results[method][name]
            (_, oracle_contribution) = results[ORACLE][name]
            numbers = (
                share,
                contribution / share if share else 0.0,
                contribution,
                contribution - oracle_contribution,
            )
            table.add_row(method, name, *(f"{number:.2f}" for number in numbers))
    Console(width=100).print(table)


if __name__ == "__main__":
    main()
