"""Clouds on lattices: bodies whose renderings have closed forms."""

import torch
from torch import Tensor

from industnerf.rendering.compositing import CompositeOutput
from industnerf.rendering.torch_renderer import render_reference


def f64(*x) -> Tensor:
    return torch.tensor(x, dtype=torch.float64)


def point_grid(counts: tuple[int, int, int], spacing: float) -> Tensor:
    """Points `spacing` apart, as many along each axis, centered on the origin."""
    axes = [(torch.arange(n, dtype=torch.float64) - (n - 1) / 2) * spacing for n in counts]
    return torch.cartesian_prod(*axes)


def render_points(
    origins: Tensor, directions: Tensor, points: Tensor, sigma: Tensor, **options
) -> CompositeOutput:
    """Rays at samples' middles through a cube of half width 2, without early end.

    `given` may hold colors (else 1), a background (else 0) and settings.
    """
    rgb = options.pop("rgb", torch.ones_like(points))
    background = options.pop("background", torch.zeros_like(origins))
    settings = {"k": 8, "weights": "inverse", "early_stop_transmittance": 0.0} | options
    corner = f64(2, 2, 2)
    offsets = torch.full_like(origins[:, 0], 0.5)
    rays = origins, directions, offsets, -corner, corner
    return render_reference(*rays, points, sigma, rgb, background, **settings)
