"""How the features of several source views join before eq. (4).  Reading R3.

The paper writes (4) for one view.  Here a point's features are pooled over the views that it
projects into.
"""

import torch
from jaxtyping import Bool, Float
from torch import Tensor

from industnerf.schema.readings import PoolReading

STATISTICS: dict[PoolReading, tuple[str, ...]] = {
    "confident": ("mean", "variance", "least", "greatest"),
    "all": ("mean", "variance", "least", "greatest"),
    "mean_variance": ("mean", "variance"),
    "mean": ("mean",),
    "surest": ("mean",),
    "max": ("greatest",),
}
DOUBT = 0.02  # how much a view counts of which nothing is known, beside one of confidence 1


def pooled_channels(channels: int, reading: PoolReading) -> int:
    """How many columns `pool` returns for features of so many."""
    return len(STATISTICS[reading]) * channels + 1


def weights_of(
    valid: Bool[Tensor, "v n"], trust: Float[Tensor, "v n"] | None, reading: PoolReading
) -> Float[Tensor, "v n 1"]:
    """How much each view counts for each point; of sum 1, or 0 for a point in no view.

    confident: as much as the view was sure of the point, (13), when the last level was done.
    surest: the one that was the surest, and no other.  Otherwise all count alike.
    As long as no view has been asked, all are equally sure; the surest is then the first.
    """
    trust = torch.ones(valid.shape, device=valid.device) if trust is None else trust
    weights = valid * (
        trust + DOUBT if reading in ("confident", "surest") else torch.ones_like(trust)
    )
    if reading == "surest":
        surest = weights.argmax(dim=0, keepdim=True)
        weights = torch.zeros_like(weights).scatter_(0, surest, weights.gather(0, surest))
    return (weights / weights.sum(dim=0).clamp(min=DOUBT))[..., None]


@torch.no_grad()
def pool(
    features: Float[Tensor, "v n c"],
    valid: Bool[Tensor, "v n"],
    weights: Float[Tensor, "v n 1"],
    reading: PoolReading,
) -> Float[Tensor, "n p"]:
    """pi(F, P, X) of eq. (4) where views are many: each point's features over its valid views.

    Of every channel the weighted mean and variance, the least and the greatest, or some of these;
    the last column is the share of valid views.  A point in no view gets zeros.

    `felt` has the gradient.
    """
    mean, squares = torch.zeros_like(features[0]), torch.zeros_like(features[0])
    least, greatest = torch.full_like(mean, torch.inf), torch.full_like(mean, -torch.inf)
    weighted, whole = torch.empty_like(mean), valid.all(dim=1).tolist()
    for number, (view, weight) in enumerate(zip(features, weights, strict=True)):  # for memory
        known, low, high = view, view, view
        if not whole[number]:
            # not multiplied by 0: outside its view a point may have any value, or none
            missed = ~valid[number][:, None]
            known, low, high = (view.masked_fill(missed, x) for x in (0, torch.inf, -torch.inf))
        torch.mul(weight, known, out=weighted)
        mean += weighted
        squares.addcmul_(weighted, known)
        torch.minimum(least, low, out=least)
        torch.maximum(greatest, high, out=greatest)
    every = {
        "mean": mean,
        "variance": (squares - mean**2).clamp(min=0),  # below 0 by rounding only
        "least": least,
        "greatest": greatest,
    }
    share = valid.to(features.dtype).mean(dim=0)[:, None]
    columns = [every[name].masked_fill(share == 0, 0) for name in STATISTICS[reading]]
    return torch.cat([*columns, share], dim=1)


def felt(
    pooled: Float[Tensor, "n p"],
    fresh: Float[Tensor, "v n c"],
    valid: Bool[Tensor, "v n"],
    weights: Float[Tensor, "v n 1"],
    reading: PoolReading,
) -> Float[Tensor, "n p"]:
    """`pooled` as it is, with the gradient that it has in the features of some of its views.

    `pooled` is what `pool` says of all views; `fresh`, `valid` and `weights` are of those that
    are to have a gradient.  The others then need no memory for one.
    """
    names = STATISTICS[reading]
    columns = dict(zip(names, pooled[:, :-1].split(fresh.shape[2], dim=1), strict=True))
    known = fresh.masked_fill(~valid[..., None], 0)

    def share(name: str) -> Float[Tensor, "n c"]:
        match name:
            case "mean":
                return (weights * known).sum(dim=0)
            case "variance":  # d/df of sum w (f - mean)^2, to which the mean adds nothing
                return (weights * (known - columns["mean"]) ** 2).sum(dim=0)
            case _:  # least, greatest: of whoever has it
                return (known * (valid[..., None] & (fresh == columns[name]))).sum(dim=0)

    shares = torch.cat([share(name) for name in names], dim=1)
    return torch.cat([pooled[:, :-1] + shares - shares.detach(), pooled[:, -1:]], dim=1)
