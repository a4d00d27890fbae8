"""The Euclidean distance transform of images and grids."""

import torch
from edt import edt
from jaxtyping import Bool, Float32
from torch import Tensor

CHUNK_CELLS = 1 << 24  # cells, of which a GPU has some five copies
CHECK_INTERVAL = 64  # steps after which a GPU is asked whether more can bring anything nearer


def distance_transform(mask: Bool[Tensor, "n *cells"]) -> Float32[Tensor, "n *cells"]:
    """Exact distance of each cell from the nearest one in the mask of its image, in cells.

    Where the mask is empty, the sum of the image's sides.
    """
    if mask.is_cuda:
        chunks = mask.split(max(1, CHUNK_CELLS // mask[0].numel()))
        distances = torch.cat([separable_edt(chunk) for chunk in chunks])
    else:
        distances = torch.stack(
            [torch.from_numpy(edt(~single_mask)) for single_mask in mask.numpy()]
        )
    return distances.clamp(max=float(sum(mask.shape[1:])))


def separable_edt(mask: Bool[Tensor, "n *cells"]) -> Float32[Tensor, "n *cells"]:
    """The same, but infinite where the mask is empty: for a GPU, on which `edt` does not run.

    Squares separate: d^2(i, j) = min_k ((i - k)^2 + min_l (j - l)^2), l over the chosen (k, l).
    """
    square = torch.where(mask, 0.0, torch.inf)
    for axis in range(1, mask.dim()):
        line = square.transpose(axis, -1).contiguous()
        best = line.clone()
        for step in range(1, line.shape[-1]):
            if step % CHECK_INTERVAL == 0 and step**2 >= best.max():
                break
            candidate = line + step**2
            torch.minimum(best[..., step:], candidate[..., :-step], out=best[..., step:])
            torch.minimum(best[..., :-step], candidate[..., step:], out=best[..., :-step])
        square = best.transpose(axis, -1)
    return square.sqrt()
