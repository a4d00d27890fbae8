"""How the features of several source views join before eq. (4).  Reading R3.

The paper writes (4) for one view.  Here a point's features are pooled over the views that it
projects into.  The other reading, in which each source view makes a cloud of its own and
confidence joins them, is not offered.
"""

from typing import assert_never, final

import torch
from jaxtyping import Bool, Float
from torch import Tensor

from industnerf.schema.readings import PoolReading


def pooled_channels(channels: int, reading: PoolReading) -> int:
    """How many columns `pool` returns for features of so many."""
    return (2 if reading == "mean_variance" else 1) * channels + 1


def pool(
    features: Float[Tensor, "v n c"], valid: Bool[Tensor, "v n"], reading: PoolReading
) -> Float[Tensor, "n p"]:
    """Each point's features over its valid views, and as last column the share of valid views.

    mean_variance: the means, then the variances about them (divided by the number of views).
    mean, max: these alone.  A point in no view gets zeros.
    """
    share = valid.to(features.dtype).mean(dim=0)[:, None]
    seen = valid[..., None]
    # not multiplied by 0: outside its view a point may have any value, or none
    known = features.masked_fill(~seen, 0)
    match reading:
        case "mean_variance":
            mean = masked_mean(known, seen)
            return torch.cat([mean, masked_mean((known - mean) ** 2, seen), share], dim=1)
        case "mean":
            return torch.cat([masked_mean(known, seen), share], dim=1)
        case "max":
            highest = known.masked_fill(~seen, -torch.inf).amax(dim=0)
            return torch.cat([highest.masked_fill(~seen.any(dim=0), 0), share], dim=1)
        case _:
            assert_never(reading)


def masked_mean(
    values: Float[Tensor, "v n c"], seen: Bool[Tensor, "v n 1"]
) -> Float[Tensor, "n c"]:
    """Mean over the views in which a point is seen; 0 where there is none."""
    return values.masked_fill(~seen, 0).sum(dim=0) / seen.sum(dim=0).clamp(min=1)


@final
class PooledSums:
    """`pool` by mean and variance over views that are exchanged a few at a time.

    Sums are kept in float64.  Features of float32 and their squares are then added and removed
    with next to no rounding, so that thousands of exchanges do not drift.
    """

    def __init__(
        self, points: int, channels: int, dtype: torch.dtype, device: torch.device
    ) -> None:
        exact = {"dtype": torch.float64, "device": device}
        self._dtype = dtype  # of what is pooled
        self._sum = torch.zeros(points, channels, **exact)
        self._squares = torch.zeros(points, channels, **exact)
        self._count = torch.zeros(points, 1, **exact)
        self._views = 0

    def add(self, features: Float[Tensor, "v n c"], valid: Bool[Tensor, "v n"]) -> None:
        """Take these views in; only what was added last can be differentiated."""
        self._change(features, valid, 1)

    def remove(self, features: Float[Tensor, "v n c"], valid: Bool[Tensor, "v n"]) -> None:
        """Take out views that were added with the same features; no gradient flows here."""
        self._change(features.detach(), valid, -1)

    def _change(
        self, features: Float[Tensor, "v n c"], valid: Bool[Tensor, "v n"], sign: int
    ) -> None:
        values = features.double().masked_fill(~valid[..., None], 0)
        self._sum = self._sum.detach() + sign * values.sum(dim=0)
        self._squares = self._squares.detach() + sign * (values**2).sum(dim=0)
        self._count = self._count + sign * valid.sum(dim=0)[:, None]
        self._views += sign * len(valid)

    def pooled(self) -> Float[Tensor, "n p"]:
        """What `pool` says of the views that are in, `mean_variance`."""
        count = self._count.clamp(min=1)
        mean = self._sum / count
        variance = (self._squares / count - mean**2).clamp(min=0)  # below 0 by rounding only
        share = self._count / max(self._views, 1)
        return torch.cat([mean, variance, share], dim=1).to(self._dtype)
