"""The cloud points around a query, by a k-d tree."""

import numpy as np
import torch
from jaxtyping import Float, Int64
from scipy.spatial import cKDTree
from torch import Tensor


def neighbors(
    queries: Float[Tensor, "q 3"],
    points: Float[Tensor, "m 3"],
    radius: float,
    k: int,
    norm: float = 2.0,
) -> tuple[Int64[Tensor, "q {k}"], Float[Tensor, "q {k}"]]:
    """Ids and distances of the at most `k` nearest points nearer than `radius`, nearest first.

    `norm`: 2 = Euclidean distances, inf = along the axis where they are farthest apart.  Rows are
    padded with id -1 and distance inf.  Positions are constants: no gradient flows.
    """
    ids, distances = np.full((len(queries), k), -1), np.full((len(queries), k), np.inf)
    if len(points) and len(queries):
        tree = cKDTree(points.detach().cpu().numpy())
        distances, found = tree.query(
            queries.detach().cpu().numpy(), range(1, k + 1), p=norm, distance_upper_bound=radius
        )
        ids = np.where(np.isfinite(distances), found, -1)
    return torch.from_numpy(ids).to(queries.device), torch.from_numpy(distances).to(queries)
