"""The cloud points around a query, by comparing it with every one of them."""

import torch
from jaxtyping import Float, Int64
from torch import Tensor

PAIRS = 2**22  # compared at once: 32 MB of float64


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
    rows = queries.detach().split(max(1, PAIRS // max(1, len(points))))
    results = [_nearest(batch, points.detach(), radius, k, norm) for batch in rows]
    return torch.cat([ids for ids, _ in results]), torch.cat([distance for _, distance in results])


def _nearest(
    queries: Float[Tensor, "q 3"], points: Float[Tensor, "m 3"], radius: float, k: int, norm: float
) -> tuple[Int64[Tensor, "q {k}"], Float[Tensor, "q {k}"]]:
    # The default expands |a-b|^2 = |a|^2 + |b|^2 - 2ab, which loses half of the digits.
    distances = torch.cdist(queries, points, norm, compute_mode="donot_use_mm_for_euclid_dist")
    distances = torch.nn.functional.pad(distances, (0, max(0, k - len(points))), value=torch.inf)
    distance, ids = distances.topk(k, largest=False)
    is_near = distance < radius
    return ids.where(is_near, -1), distance.where(is_near, torch.inf)
