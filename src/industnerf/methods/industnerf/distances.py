"""The distance transform of images and lattices."""

import torch
from edt import edt
from jaxtyping import Bool, Float32
from torch import Tensor

AT_ONCE = 1 << 24  # cells, of which a GPU has some five copies
LOOK = 64  # steps after which a GPU is asked whether more can bring anything nearer


def distance_transform(chosen: Bool[Tensor, "n *cells"]) -> Float32[Tensor, "n *cells"]:
    """How far each cell is from the nearest chosen one of its image, in cells.

    Euclidean and exact; where nothing is chosen, the sum of the image's sides.
    """
    if chosen.is_cuda:
        few = chosen.split(max(1, AT_ONCE // chosen[0].numel()))
        away = torch.cat([along_the_axes(some) for some in few])
    else:
        away = torch.stack([torch.from_numpy(edt(~one)) for one in chosen.numpy()])
    return away.clamp(max=float(sum(chosen.shape[1:])))


def along_the_axes(chosen: Bool[Tensor, "n *cells"]) -> Float32[Tensor, "n *cells"]:
    """The same, but infinite where nothing is chosen: for a GPU, on which `edt` does not run.

    Squares separate: d^2(i, j) = min_k ((i - k)^2 + min_l (j - l)^2), l over the chosen (k, l).
    """
    square = torch.where(chosen, 0.0, torch.inf)
    for axis in range(1, chosen.dim()):
        along = square.transpose(axis, -1).contiguous()
        best = along.clone()
        for step in range(1, along.shape[-1]):
            if step % LOOK == 0 and step**2 >= best.max():
                break
            aside = along + step**2
            torch.minimum(best[..., step:], aside[..., :-step], out=best[..., step:])
            torch.minimum(best[..., :-step], aside[..., step:], out=best[..., :-step])
        square = best.transpose(axis, -1)
    return square.sqrt()
