"""Section 3.2, eqs. (5)-(9): the density grid as a distribution, and inverse transform sampling.

Axes of a grid are x, y, z; its cell (i, j, k) spans [i, i+1] x [j, j+1] x [k, k+1].  Everything
is in float64, because cells of very unequal densities share one sum.  Readings R5 and R6.
"""

from typing import assert_never

import torch
from jaxtyping import Float, Float64, Int64
from torch import Tensor

from industnerf.errors import ReconstructionFailed
from industnerf.schema.readings import SamplePositionReading, SamplingDensityReading

DensityGrid = Float64[Tensor, "x y z"]


def sampling_density(
    sigma: Float[Tensor, "x y z"],
    visibility: Float[Tensor, "x y z"],
    reading: SamplingDensityReading,
) -> Float[Tensor, "x y z"]:
    """The density of eq. (5).  Reading R6.

    density: sigma, as printed; most points are then sampled inside the solid, where no view sees
    them, and still the result is better on dev parts.
    visible_density: sigma times `visibility`, in [0, 1].
    """
    match reading:
        case "density":
            return sigma
        case "visible_density":
            return sigma * visibility
        case _:
            assert_never(reading)


def pdf(sigma: Float[Tensor, "x y z"]) -> DensityGrid:
    """Eq. (5): each cell's share of the density.

    Raises ReconstructionFailed if a density is negative or not finite, or if all are zero.
    """
    invalid_count = int((~(sigma.isfinite() & (sigma >= 0))).sum())
    if invalid_count:
        raise ReconstructionFailed(
            f"{invalid_count} of {sigma.numel()} densities are negative or not finite: they are no "
            "distribution"
        )
    density = sigma.double()
    if not density.any():
        raise ReconstructionFailed(
            f"all {sigma.numel()} densities are zero: the field is empty, nothing can be sampled"
        )
    return density / density.sum()


def effective_cells(sigma: Float[Tensor, "x y z"]) -> float:
    """Effective number of cells, (sum p)^2 / sum p^2: n if n cells have equal shares."""
    p = pdf(sigma)
    return 1 / float((p**2).sum())


def marginal_xy(p: DensityGrid) -> Float64[Tensor, "x y"]:
    """Eq. (6)."""
    return p.sum(dim=2)


def marginal_x(p: DensityGrid) -> Float64[Tensor, "x"]:
    """Eq. (7)."""
    return marginal_xy(p).sum(dim=1)


def y_given_x(p: DensityGrid) -> Float64[Tensor, "x y"]:
    """Eq. (8); rows without any mass are 0."""
    return _safe_divide(marginal_xy(p), marginal_x(p)[:, None])


def z_given_xy(p: DensityGrid) -> DensityGrid:
    """Eq. (9); columns without any mass are 0."""
    return _safe_divide(p, marginal_xy(p)[:, :, None])


def _safe_divide(
    numerator: Float64[Tensor, "*n"], denominator: Float64[Tensor, "*w"]
) -> Float64[Tensor, "*n"]:
    return torch.where(denominator > 0, numerator / denominator, 0)


def inverse_transform_sample(
    sigma: Float[Tensor, "x y z"], uniforms: Float[Tensor, "n 3"], reading: SamplePositionReading
) -> Float64[Tensor, "n 3"]:
    """Points distributed like `sigma`, in cells: within [0, rx] x [0, ry] x [0, rz].

    One uniform of [0, 1] an axis selects the cell: x by (7), y by (8), z by (9).  jitter: what
    is left of the uniform places the point in the cell, so that the draw is the exact inverse
    of the piecewise linear distribution functions.  center: the cell's center.
    A cell without density is never drawn.  Draws have no gradient.  Errors as of `pdf`.
    """
    p, u = pdf(sigma.detach()), uniforms.double()
    x, fraction_x = invert_cdf(marginal_x(p).cumsum(0).repeat(len(u), 1), u[:, 0])
    y, fraction_y = invert_cdf(y_given_x(p).cumsum(1)[x], u[:, 1])
    z, fraction_z = invert_cdf(z_given_xy(p).cumsum(2)[x, y], u[:, 2])
    cell = torch.stack([x, y, z], dim=1).double()
    match reading:
        case "jitter":
            samples = cell + torch.stack([fraction_x, fraction_y, fraction_z], dim=1)
            return samples.minimum((cell + 1).nextafter(cell))  # not rounded into the next cell
        case "center":
            return cell + 0.5
        case _:
            assert_never(reading)


def invert_cdf(
    cdf: Float64[Tensor, "n r"], u: Float64[Tensor, "n"]
) -> tuple[Int64[Tensor, "n"], Float64[Tensor, "n"]]:
    """The cell in which the share `u` of a row's mass is reached, and where in the cell, in [0, 1].

    Rows of `cdf` are cumulative masses; the last need not be 1.
    """
    total = cdf[:, -1]
    # 1, or what rounds to it, belongs to the last cell with mass
    target = (u * total).minimum(total.nextafter(torch.zeros_like(total)))
    # the first cell that reaches beyond the target: never one without mass
    cell = torch.searchsorted(cdf, target[:, None], right=True)
    after = cdf.gather(1, cell)
    before = torch.where(cell > 0, cdf.gather(1, (cell - 1).clamp(min=0)), 0)
    return cell[:, 0], ((target[:, None] - before) / (after - before))[:, 0]


def latin_hypercube(count: int, generator: torch.Generator) -> Float64[Tensor, "count 3"]:
    """Uniforms of which each axis has exactly one in every [i, i+1] / count: a Latin hypercube."""
    strata = [torch.randperm(count, generator=generator) for _ in range(3)]
    offsets = torch.rand(count, 3, dtype=torch.float64, generator=generator)
    return (torch.stack(strata, dim=1) + offsets) / count
