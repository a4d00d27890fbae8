"""How fast do the compiled kernels march, against plain torch and against scipy's k-d tree?

OMP_NUM_THREADS=1 python benchmarks/kernels.py [radius ...]     in spacings; 0.9 and 1.2 by default

A shell of some 100 000 points, one in each cell of a grid; rays from outside that all hit it,
a sample every spacing, 8 neighbours.  `forward` and `backward` are nanoseconds a sample of the
rays in the box, whether or not there is a point near it, so that all ways are counted alike;
`times` is both of them over those of the kernels.  The three ways take turns and the median of
the turns counts, so that a busy machine stretches all of them.

Then what skipping and ending early save; and tents, whose points may be anywhere, or stand
on a lattice, where only the corners of a cube are looked into.

`twin` compares every sample with every point.  It is what the kernels are tested against, and is
given fewer rays.  `k-d tree` is what one would write without kernels: scipy finds neighbours,
torch composites and differentiates.
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from time import process_time
from typing import Any

import numpy as np
import torch
from rich.console import Console
from rich.table import Table
from scipy.spatial import cKDTree
from torch import Tensor

from industnerf.rendering.compositing import opacities, stopped, transmittance
from industnerf.rendering.points import Points
from industnerf.rendering.render import Rays, Renderer
from industnerf.rendering.samples import Samples, rays_in_cube
from industnerf.rendering.twin import render_twin
from industnerf.rendering.weights import inverse_distance_weights
from industnerf.schema.readings import WeightReading

SPACING, NEIGHBOURS, READING = 1 / 64, 8, "inverse_square"
SHELL = 0.56, 0.645  # between these distances from the middle of [-1, 1]^3 the points are
CORE = 0.2, 0.285  # in a ball full of points, only those between these have density
RAYS, TWIN_RAYS, TURNS = 4096, 8, 5
DENSITY = {"thin": 0.2, "opaque": 200.0}  # a ray through the shell keeps 0.9, or nothing
Look = Callable[[Rays, Tensor, Tensor], Tensor]  # rays, densities and colours -> pixels


@dataclass(frozen=True)
class Cloud:
    positions: Tensor
    sigma: Tensor
    rgb: Tensor
    radius: float
    stop: float


def cloud(radius: float, density: float, *, ball: bool = False, shaken: bool = True) -> Cloud:
    """The shell, or a `ball` as wide, full of points of which few have density.

    Points are anywhere in their cells if they are `shaken`, else in the corners.
    """
    random = torch.Generator().manual_seed(0)
    axis = torch.arange(-1, 1, SPACING)
    points = torch.cartesian_prod(axis, axis, axis)
    points += SPACING * torch.rand(points.shape, generator=random) * shaken
    away = points.norm(dim=1)
    inner, (lowest, highest) = (0.0, CORE) if ball else (SHELL[0], SHELL)
    points, away = (x[(inner < away) & (away < SHELL[1])] for x in (points, away))
    rgb = torch.rand(points.shape, generator=random)
    sigma = density * ((lowest < away) & (away < highest))
    return Cloud(points, sigma, rgb, radius * SPACING, 0.01)


def rays(count: int) -> Rays:
    """From a sphere of radius 3 towards places within the shell."""
    random = torch.Generator().manual_seed(1)
    eyes, aims = (
        torch.nn.functional.normalize(torch.randn(count, 3, generator=random), dim=1)
        for _ in range(2)
    )
    eyes, aims = 3 * eyes, 0.5 * aims
    towards = torch.nn.functional.normalize(aims - eyes, dim=1)
    return Rays(eyes, towards, torch.rand(count, generator=random))


def box() -> tuple[Tensor, Tensor]:
    return -torch.ones(3), torch.ones(3)


def inside(some: Rays) -> tuple[Tensor, Tensor]:
    return rays_in_cube(some.origins, some.directions, some.offsets, *box(), SPACING)


def compiled(
    given: Cloud,
    *,
    skipping: bool = True,
    filled: Tensor | None = None,
    reading: WeightReading = READING,
    lattice: bool = False,
) -> Look:
    """The kernels; `skipping` space without a point, or without one that is `filled`.

    Points of a `lattice` are looked up, not searched.
    """
    points = Points(given.positions, given.radius, NEIGHBOURS, reading)
    points.cells.lattice = lattice
    if filled is not None:
        points.fill(filled[points.order])
    if not skipping:
        points._away.zero_()
    renderer = Renderer(points, (-1.0,) * 3, (1.0,) * 3, SPACING, given.stop)

    def look(some: Rays, sigma: Tensor, rgb: Tensor) -> Tensor:
        seen = renderer.look(some, sigma[points.order], rgb[points.order])
        return seen.over(torch.ones(len(some), 3))

    return look


def twin(given: Cloud) -> Look:
    ways = {"step": SPACING, "radius": given.radius, "k": NEIGHBOURS, "weights": READING}

    def look(some: Rays, sigma: Tensor, rgb: Tensor) -> Tensor:
        at = some.origins, some.directions, some.offsets, *box(), given.positions
        white = torch.ones(len(some), 3)
        return render_twin(*at, sigma, rgb, white, **ways, stop=given.stop).rgb

    return look


def with_tree(given: Cloud) -> Look:
    tree = cKDTree(given.positions.numpy())

    def look(some: Rays, sigma: Tensor, rgb: Tensor) -> Tensor:
        t, within = inside(some)
        at = (some.origins[:, None] + t[:, :, None] * some.directions[:, None])[within]
        far, near = tree.query(at.numpy(), NEIGHBOURS, distance_upper_bound=given.radius)
        distance = torch.full((*t.shape, NEIGHBOURS), torch.inf)
        distance[within] = torch.from_numpy(far).float()
        ids = torch.full((*t.shape, NEIGHBOURS), -1)
        ids[within] = torch.from_numpy(np.where(np.isfinite(far), near, -1))
        weights = inverse_distance_weights(distance, given.radius, READING)
        field = Samples(t, ids, weights).mean(torch.cat([sigma[:, None], rgb], dim=1))
        density = stopped(field[..., 0], SPACING, given.stop)
        left = transmittance(density, SPACING)
        shares = left[:, :-1] * opacities(density, SPACING)
        return (shares[:, :, None] * field[..., 1:]).sum(dim=1) + left[:, -1:]

    return look


def timed(look: Look, given: Cloud, some: Rays) -> np.ndarray:
    """Nanoseconds a sample, forward and backward."""
    sigma, rgb = (x.clone().requires_grad_() for x in (given.sigma, given.rgb))
    times = [process_time()]
    loss = (look(some, sigma, rgb) ** 2).mean()
    times.append(process_time())
    loss.backward()
    times.append(process_time())
    return 1e9 * np.diff(times) / int(inside(some)[1].sum())


def in_turns(ways: dict[Any, tuple[Look, Cloud, Rays]]) -> dict[Any, np.ndarray]:
    """The median of TURNS for each, after one that compiles."""
    for way in ways.values():
        timed(*way)
    turns = [[timed(*way) for way in ways.values()] for _ in range(TURNS)]
    return dict(zip(ways, np.median(turns, axis=0), strict=True))


def against_others(radii: list[float]) -> Table:
    heads = "radius", "density", "way", "forward ns", "backward ns", "times", "off by"
    table = Table(*heads, title=f"a sample; {len(cloud(1, 1).positions)} points, {RAYS} rays")
    for radius in radii:
        for name, density in DENSITY.items():
            given, many, few = cloud(radius, density), rays(RAYS), rays(TWIN_RAYS)
            ways = {"kernels": compiled(given), "k-d tree": with_tree(given), "twin": twin(given)}
            found = in_turns(
                {way: (look, given, few if way == "twin" else many) for way, look in ways.items()}
            )
            pixels = {way: look(few, given.sigma, given.rgb) for way, look in ways.items()}
            for way, (ahead, back) in found.items():
                times = (ahead + back) / sum(found["kernels"])
                off = (pixels[way] - pixels["twin"]).abs().max().item()
                cells = f"{ahead:.1f}", f"{back:.1f}", f"{times:.1f}", f"{off:.0e}"
                table.add_row(f"{radius:g}", name, way, *cells)
    return table


def what_is_saved(radii: list[float]) -> Table:
    heads = "radius", "points", "rays end", "skipped", "forward ns", "backward ns"
    table = Table(*heads, title="a sample, opaque: what skipping and ending early save")
    for radius in radii:
        for ball in (False, True):
            whole, ways = cloud(radius, DENSITY["opaque"], ball=ball), {}
            for end, stop in {"early": 0.01, "never": 0.0}.items():
                given, some = replace(whole, stop=stop), rays(RAYS)
                ways[end, "nothing"] = compiled(given, skipping=False), given, some
                ways[end, "without points"] = compiled(given), given, some
                if ball:
                    filled = compiled(given, filled=given.sigma > 0)
                    ways[end, "without density"] = filled, given, some
            name = f"{len(whole.positions)}, {'ball' if ball else 'shell'}"
            for way, times in in_turns(ways).items():
                table.add_row(f"{radius:g}", name, *way, *(f"{time:.1f}" for time in times))
    return table


def on_a_lattice() -> Table:
    heads = "density", "points are", "forward ns", "backward ns", "times"
    table = Table(*heads, title="a sample, tents")
    for name, density in DENSITY.items():
        given, some = cloud(1.0, density, shaken=False), rays(RAYS)
        looks = {
            "searched": compiled(given, reading="tent"),
            "looked up": compiled(given, reading="tent", lattice=True),
        }
        found = in_turns({way: (look, given, some) for way, look in looks.items()})
        for way, (ahead, back) in found.items():
            times = (ahead + back) / sum(found["looked up"])
            table.add_row(name, way, f"{ahead:.1f}", f"{back:.1f}", f"{times:.2f}")
    return table


def main(radii: list[float]) -> None:
    torch.set_num_threads(1)
    console = Console(width=110)
    console.print(against_others(radii))
    console.print(what_is_saved(radii))
    console.print(on_a_lattice())


if __name__ == "__main__":
    main([float(argument) for argument in sys.argv[1:]] or [0.9, 1.2])
