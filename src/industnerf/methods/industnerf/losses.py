"""What a step asks of the rays that it looked at: the error of their pixels, which is the paper's.

The others are additions, and 0 where their weight is.
"""

import torch
from jaxtyping import Float32
from torch import Tensor

from industnerf.rendering.render import Seen


def error(
    seen: Seen, background: Float32[Tensor, "r 3"], target: Float32[Tensor, "r 3"]
) -> Float32[Tensor, ""]:
    """Mean squared error of the re-rendered pixels before their background, R10."""
    return ((seen.over(background) - target) ** 2).mean()


def preference(seen: Seen, emptiness: float, veil: float) -> Float32[Tensor, ""] | float:
    """Of fields that re-render alike, rather the emptier one, and the one without veils.

    Matter of the background's colour anywhere outside the part is as good as none; a thin
    veil of black before a white background is as good as grey.
    """
    if not (emptiness or veil):
        return 0.0
    matter = emptiness * (1 - seen.through).mean()
    return matter + veil * (seen.through * (1 - seen.through)).mean()


def off_depth(
    seen: Seen, read: Float32[Tensor, "r"] | None, weight: float
) -> Float32[Tensor, ""] | float:
    """How far what is seen is from the readings of depth, if there are any; 0 is no reading.

    Light that passes where there is a surface counts as a radius of the region of interest.
    """
    if read is None:
        return 0.0
    off = (1 - seen.through) * (seen.depth - read).abs() + seen.through
    return weight * torch.where(read > 0, off, 0.0).mean()
