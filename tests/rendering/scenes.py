"""Small clouds, and rays at them, to compare renderers on.

All numbers are float32 ones held in float64, so that a renderer in either sees the same scene.
"""

from dataclasses import dataclass, replace
from typing import Any

import torch
from torch import Tensor

LO, HI = torch.tensor([-1.0, -0.75, -1.25]), torch.tensor([1.0, 1.0, 0.875])


@dataclass(frozen=True)
class RenderScene:
    """The arguments of a renderer, under the names that it has for them."""

    origins: Tensor
    directions: Tensor
    offsets: Tensor
    lo: Tensor
    hi: Tensor
    points: Tensor
    sigma: Tensor
    rgb: Tensor
    background: Tensor
    agreement: Tensor  # S of eq. (12), per ray
    settings: dict[str, Any]  # step, radius, k, weights, stop; beta: sigma is a signed distance

    @property
    def rays(self) -> tuple[Tensor, ...]:
        """Origins, directions, offsets and the cube: what every renderer begins with."""
        return self.origins, self.directions, self.offsets, self.lo, self.hi

    @property
    def render_inputs(self) -> tuple[Tensor, ...]:
        """Of `render_reference`, in its order."""
        return *self.rays, self.points, self.sigma, self.rgb, self.background

    @property
    def confidence_inputs(self) -> tuple[Tensor, ...]:
        """Of `confidence_reference`, in its order."""
        return *self.rays, self.points, self.sigma, self.agreement

    def to(self, dtype: torch.dtype) -> "RenderScene":
        """The same in another precision."""
        tensors = {name: x.to(dtype) for name, x in vars(self).items() if torch.is_tensor(x)}
        return replace(self, **tensors)

    def with_settings(self, **changes: Any) -> "RenderScene":
        """The same seen otherwise."""
        return replace(self, settings=self.settings | changes)


def random_scene(seed: int, points: int, rays: int = 40, **settings: Any) -> RenderScene:
    """Points throughout the cube, every fifth of them empty, and rays of all kinds at it.

    `settings` may set `density`, the mean of the other sigmas; the rest are a Scene's.
    """
    rng = torch.Generator().manual_seed(seed)
    size = HI - LO
    cloud = LO + size * torch.rand(points, 3, generator=rng)
    sigma = settings.pop("density", 4.0) * -torch.log1p(-torch.rand(points, generator=rng))
    sigma[::5] = 0
    if "beta" in settings:  # then these are distances
        sigma = sigma.mean() - sigma
    origins, directions = _rays(rays, rng)
    scene = RenderScene(
        origins,
        directions,
        torch.rand(rays, generator=rng),
        LO,
        HI,
        cloud,
        sigma,
        torch.rand(points, 3, generator=rng),
        torch.rand(rays, 3, generator=rng),
        torch.rand(rays, generator=rng),
        {
            "step": 0.0625,
            "radius": 0.25,
            "k": 8,
            "weights": "inverse",
            "early_stop_transmittance": 1e-3,
        }
        | settings,
    )
    return scene.to(torch.float64)


def grid_scene(seed: int, spacing: float = 0.25, **settings: Any) -> RenderScene:
    """`random_scene` with tents on the points of a lattice, every seventh of which is missing.

    Two and a half spacings of the cube are left empty on all sides, so that there are samples
    beyond the cells that points are sorted into.
    """
    ends = zip(LO + 2.5 * spacing, HI - 2 * spacing, strict=True)
    axes = [torch.arange(lo, hi, spacing) for lo, hi in ends]
    points = torch.cartesian_prod(*axes)
    points = points[torch.arange(len(points)) % 7 > 0]
    settings |= {"radius": spacing, "weights": "trilinear"}
    return replace(random_scene(seed, len(points), **settings), points=points.double())


def _rays(count: int, rng: torch.Generator) -> tuple[Tensor, Tensor]:
    """Towards random points of the cube, mostly from outside; the last few are special."""
    origins = torch.nn.functional.normalize(torch.randn(count, 3, generator=rng), dim=1) * 3
    origins[::4] /= 8  # these start inside
    towards = LO + (HI - LO) * torch.rand(count, 3, generator=rng) - origins
    origins[-1], towards[-1] = torch.tensor([0.1, 0.2, -4.0]), torch.tensor([0.0, 0.0, 1.0])
    origins[-2], towards[-2] = torch.tensor([3.0, 0.3, 0.1]), torch.tensor([-1.0, 0.0, 0.0])
    origins[-3], towards[-3] = torch.tensor([3.0, 0.3, 0.1]), torch.tensor([1.0, 0.1, 0.0])  # away
    origins[-4], towards[-4] = torch.tensor([0.0, 3.0, 0.0]), torch.tensor([1.0, 0.0, 0.0])  # past
    return origins, torch.nn.functional.normalize(towards, dim=1)


SCENES = {
    "gappy": random_scene(1, 60),
    "crowded": random_scene(12, 1500, k=4),  # some twelve points within the radius
    "opaque": random_scene(
        3, 400, density=60.0, early_stop_transmittance=0.01
    ),  # most rays end early
    "thin": random_scene(4, 400, density=0.05, early_stop_transmittance=0.0),
    "single": random_scene(5, 1),
    "inverse_square": random_scene(6, 400, weights="inverse_square"),
    "modified_shepard": random_scene(7, 400, weights="modified_shepard"),
    "trilinear": random_scene(8, 400, weights="trilinear"),
    "grid": grid_scene(10, 0.125),
    "sdf": random_scene(
        9, 400, weights="trilinear", density=0.3, beta=0.05, early_stop_transmittance=0.01
    ),
}
