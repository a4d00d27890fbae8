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
from industnerf.geometry.raycast import Scene
from industnerf.geometry.visibility import seen_from
from industnerf.metrics.protocol import Judge
from industnerf.metrics.reduce import farthest_points
from industnerf.metrics.visible import ON_SURFACE
from industnerf.seeds import generator

METHODS = ["industnerf_plus", "industnerf", "hull", "oracle"]
PERFECT = "oracle"  # what is left over of it is no method's fault
GROUPS = {"at most 1": (0, 1), "2 to 3": (2, 3), "4 to 7": (4, 7), "8 or more": (8, np.inf)}
EVERY = "all"


@dataclass(frozen=True)
class Group:
    """Points of one part that about as many cameras see."""

    share: float
    added: float  # floors


def groups_of(data: Path, part_id: str, method: str) -> dict[str, Group]:
    """How far the true surface of one part is from a cloud, group by group."""
    params, part = load_params(), data / "parts" / part_id
    judge = Judge(part, Truth.load(data / "truth" / part_id), params.evaluate, params.seed)
    cloud = Cloud.load(data / "clouds" / method / part_id).points_mm
    shown = judge.sampled(cloud, generator(params.seed, "evaluate", part_id))
    truth, count = judge.truth, params.evaluate.points
    truth = farthest_points(truth.points[truth.kept], count)
    carried = distances(farthest_points(shown.points[shown.kept], count), truth)
    carried /= judge.known.floors["emd P1-even"]
    seen = cameras_that_see(judge, truth, data / "views" / part_id)
    found = {EVERY: Group(1.0, carried.mean())}
    for name, (least, most) in GROUPS.items():
        of_group = (seen >= least) & (seen <= most)
        found[name] = Group(of_group.mean(), carried[of_group].sum() / len(truth))
    return found


def distances(
    cloud: Float[np.ndarray, "n 3"], truth: Float[np.ndarray, "m 3"]
) -> Float[np.ndarray, "m"]:
    """How far each point of the truth is from what is carried onto it; the mean is the EMD."""
    cost = cdist(cloud, truth)
    masses = (np.full(size, 1 / size) for size in cost.shape)
    plan, log = ot.emd(*masses, cost, numItermax=10**8, log=True)
    if log["warning"]:
        raise RuntimeError(f"POT did not solve it: {log['warning']}")
    return (plan * cost).sum(axis=0) * len(truth)


def cameras_that_see(
    judge: Judge, truth: Float[np.ndarray, "m 3"], views: Path
) -> Int[np.ndarray, "m"]:
    """How many training cameras see each point, given in diagonals."""
    taken, frame = load_views(views), judge.frame
    scene = Scene(frame.mesh.vertices, frame.mesh.faces)
    points = truth * frame.diagonal_mm + frame.centre
    reach = ON_SURFACE * frame.diagonal_mm
    eyes = taken.cameras[taken.train].eyes
    return sum(seen_from(scene, points, eye[None], reach).astype(int) for eye in eyes)


def rows(parts: list[dict[str, Group]]) -> dict[str, tuple[float, float]]:
    """Share and floors added, mean over parts, group by group."""
    gathered = defaultdict(list)
    for part in parts:
        for name, group in part.items():
            gathered[name].append((group.share, group.added))
    return {name: tuple(np.mean(values, axis=0)) for name, values in gathered.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("data", type=Path)
    parser.add_argument("--methods", nargs="+", default=METHODS)
    parser.add_argument("--split", default="dev")
    asked = parser.parse_args()
    split = load_split(asked.data / "split.json")
    chosen = [part_id for part_id, place in split.items() if place.split == asked.split]
    table = Table(title=f"{len(chosen)} {asked.split} parts, floors")
    for head in ("method", "seen by", "share", "carried", "part", "excess"):
        table.add_column(head, justify="left" if head in ("method", "seen by") else "right")
    found = {}
    with ProcessPoolExecutor() as pool:
        for method in dict.fromkeys([*asked.methods, PERFECT]):
            work = pool.map(partial(groups_of, asked.data, method=method), chosen)
            found[method] = rows(list(track(work, method, len(chosen))))
    for method in asked.methods:
        for name in (*GROUPS, EVERY):
            (share, added), (_, perfect) = found[method][name], found[PERFECT][name]
            numbers = share, added / share if share else 0.0, added, added - perfect
            table.add_row(method, name, *(f"{number:.2f}" for number in numbers))
    Console(width=100).print(table)


if __name__ == "__main__":
    main()
