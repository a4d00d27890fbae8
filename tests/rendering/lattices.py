"""Clouds on lattices: bodies whose renderings have closed forms."""

import torch
from torch import Tensor

from industnerf.rendering.compositing import Rendered
from industnerf.rendering.twin import render_twin


def f64(*x) -> Tensor:
    return torch.tensor(x, dtype=torch.float64)


def lattice(counts: tuple[int, int, int], spacing: float) -> Tensor:
    """Points `spacing` apart, as many along each axis, centred on the origin."""
    axes = [(torch.arange(n, dtype=torch.float64) - (n - 1) / 2) * spacing for n in counts]
    return torch.cartesian_prod(*axes)


def look(origins: Tensor, directions: Tensor, points: Tensor, sigma: Tensor, **given) -> Rendered:
    """Rays at samples' middles through a cube of half width 2, without early end.

    `given` may hold colours (else 1), a background (else 0) and settings.
    """
    rgb = given.pop("rgb", torch.ones_like(points))
    background = given.pop("background", torch.zeros_like(origins))
    settings = {"k": 8, "weights": "inverse", "stop": 0.0} | given
    corner = f64(2, 2, 2)
    middles = torch.full_like(origins[:, 0], 0.5)
    rays = origins, directions, middles, -corner, corner
    return render_twin(*rays, points, sigma, rgb, background, **settings)
