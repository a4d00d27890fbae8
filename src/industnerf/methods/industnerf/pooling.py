"""Section 3.1, pi(F, P, X) of eq. (4) of several source views.  Reading R3.

The paper writes (4) for one view.  Here a point's features are pooled over the views that it
projects into.
"""

import torch
from jaxtyping import Bool, Float
from torch import Tensor

from industnerf.schema.readings import ViewPoolingReading

STATISTICS: dict[ViewPoolingReading, tuple[str, ...]] = {
    "confidence_weighted": ("mean", "variance", "min", "max"),
    "all": ("mean", "variance", "min", "max"),
    "mean_variance": ("mean", "variance"),
    "mean": ("mean",),
    "argmax_confidence": ("mean",),
    "max": ("max",),
}
MIN_VIEW_WEIGHT = 0.02  # of a view of confidence 0, where one of confidence 1 has 1.02


def pooled_channels(channels: int, reading: ViewPoolingReading) -> int:
    """Columns of `pool` for features of so many channels."""
    return len(STATISTICS[reading]) * channels + 1


def pooling_weights(
    valid: Bool[Tensor, "v n"],
    view_weights: Float[Tensor, "v n"] | None,
    reading: ViewPoolingReading,
) -> Float[Tensor, "v n 1"]:
    """Weight of each view for each point, of sum 1, or 0 for a point in no view.  Reading R3.

    confidence_weighted: by the view's confidence (13) in the point, as last computed.
    argmax_confidence: all of it to the view of the highest confidence.  Otherwise equal weights.
    Without `view_weights` all confidences are equal; the highest is then that of the first view.
    """
    if view_weights is None:
        view_weights = torch.ones(valid.shape, device=valid.device)
    if reading in ("confidence_weighted", "argmax_confidence"):
        weights = valid * (view_weights + MIN_VIEW_WEIGHT)
    else:
        weights = valid * torch.ones_like(view_weights)
    if reading == "argmax_confidence":
        best_view = weights.argmax(dim=0, keepdim=True)
        weights = torch.zeros_like(weights).scatter_(0, best_view, weights.gather(0, best_view))
    return (weights / weights.sum(dim=0).clamp(min=MIN_VIEW_WEIGHT))[..., None]


@torch.no_grad()
def pool(
    features: Float[Tensor, "v n c"],
    valid: Bool[Tensor, "v n"],
    weights: Float[Tensor, "v n 1"],
    reading: ViewPoolingReading,
) -> Float[Tensor, "n p"]:
    """pi(F, P, X) of eq. (4), pooled: each point's features over its valid views.

    Of every channel the weighted mean and variance, minimum and maximum, or some of these; the
    last column is the share of valid views.  A point in no view gets zeros.  There is no
    gradient: see `attach_gradient`.
    """
    mean, mean_square = torch.zeros_like(features[0]), torch.zeros_like(features[0])
    minimum, maximum = torch.full_like(mean, torch.inf), torch.full_like(mean, -torch.inf)
    weighted, is_in_all = torch.empty_like(mean), valid.all(dim=1).tolist()
    for index, (view, weight) in enumerate(zip(features, weights, strict=True)):  # for memory
        masked, low, high = view, view, view
        if not is_in_all[index]:
            # not multiplied by 0: outside its view a point may have any value, or none
            out_of_view = ~valid[index][:, None]
            masked, low, high = (
                view.masked_fill(out_of_view, x) for x in (0, torch.inf, -torch.inf)
            )
        torch.mul(weight, masked, out=weighted)
        mean += weighted
        mean_square.addcmul_(weighted, masked)
        torch.minimum(minimum, low, out=minimum)
        torch.maximum(maximum, high, out=maximum)
    statistics = {
        "mean": mean,
        "variance": (mean_square - mean**2).clamp(min=0),  # below 0 by rounding only
        "min": minimum,
        "max": maximum,
    }
    valid_fraction = valid.to(features.dtype).mean(dim=0)[:, None]
    columns = [statistics[name].masked_fill(valid_fraction == 0, 0) for name in STATISTICS[reading]]
    return torch.cat([*columns, valid_fraction], dim=1)


def attach_gradient(
    pooled: Float[Tensor, "n p"],
    fresh: Float[Tensor, "v n c"],
    valid: Bool[Tensor, "v n"],
    weights: Float[Tensor, "v n 1"],
    reading: ViewPoolingReading,
) -> Float[Tensor, "n p"]:
    """`pooled` unchanged, with its gradient in the features of some of the views.

    `pooled` is the result of `pool` on all views; `fresh`, `valid` and `weights` are those of the
    views with a gradient.  The others need no memory for one.
    """
    names = STATISTICS[reading]
    columns = dict(zip(names, pooled[:, :-1].split(fresh.shape[2], dim=1), strict=True))
    masked = fresh.masked_fill(~valid[..., None], 0)

    def gradient_term(name: str) -> Float[Tensor, "n c"]:
        match name:
            case "mean":
                return (weights * masked).sum(dim=0)
            case "variance":  # d/df of sum w (f - mean)^2, to which the mean adds nothing
                return (weights * (masked - columns["mean"]) ** 2).sum(dim=0)
            case _:  # min, max: of the views that have it
                return (masked * (valid[..., None] & (fresh == columns[name]))).sum(dim=0)

    gradient_terms = torch.cat([gradient_term(name) for name in names], dim=1)
    return torch.cat(
        [pooled[:, :-1] + gradient_terms - gradient_terms.detach(), pooled[:, -1:]], dim=1
    )
