"""How fast do the compiled kernels march, against plain torch and against scipy's k-d tree?

OMP_NUM_THREADS=1 python benchmarks/kernels.py [radius ...]     in spacings; 0.9 and 1.2 by default

A shell of some 100 000 points, one in each cell of a grid; rays from outside that all hit it,
a sample every spacing, 8 neighbors.  `forward` and `backward` are nanoseconds a sample of the
rays in the box, whether or not there is a point near it, so that all ways are counted alike;
`times` is both of them over those of the kernels.  The three ways take turns and the median of
the turns counts, so that a busy machine stretches all of them.

Then what skipping and ending early save; and tents, whose points may be anywhere, or stand
on a lattice, where only the corners of a cube are looked into.

`twin` compares every sample with every point.  It is what the kernels are tested against, and is
given fewer rays.  `k-d tree` is what one would write without kernels: scipy finds neighbors,
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

from industnerf.rendering.compiled_renderer import CompiledRenderer
from industnerf.rendering.compositing import opacities, terminated_density, transmittance
from industnerf.rendering.points import PointGrid
from industnerf.rendering.render import Rays
from industnerf.rendering.samples import Samples, sample_distances
from industnerf.rendering.torch_renderer import render_reference
from industnerf.rendering.weights import inverse_distance_weights
from industnerf.schema.readings import InterpolationReading

SPACING, NEIGHBORS, READING = 1 / 64, 8, "inverse_square"
SHELL_RADII = 0.56, 0.645  # between these distances from the middle of [-1, 1]^3 the points are
CORE_RADII = 0.2, 0.285  # in a ball full of points, only those between these have density
RAYS, REFERENCE_RAYS, REPEATS = 4096, 8, 5
DENSITY = {"thin": 0.2, "opaque": 200.0}  # a ray through the shell keeps 0.9, or nothing
RenderFunction = Callable[[Rays, Tensor, Tensor], Tensor]  # rays, densities and colors -> pixels


@dataclass(frozen=True)
class Cloud:
    positions: Tensor
    sigma: Tensor
    rgb: Tensor
    radius: float
    stop: float


def make_cloud(
    radius: float, density: float, *, ball: bool = False, jittered: bool = True
) -> Cloud:
    """The shell, or a `ball` as wide, full of points of which few have density.

    Points are anywhere in their cells if they are `shaken`, else in the corners.
    """
    random = torch.Generator().manual_seed(0)
    axis = torch.arange(-1, 1, SPACING)
    points = torch.cartesian_prod(axis, axis, axis)
    points += SPACING * torch.rand(points.shape, generator=random) * jittered
    radii = points.norm(dim=1)
    inner, (lowest, highest) = (0.0, CORE_RADII) if ball else (SHELL_RADII[0], SHELL_RADII)
    points, radii = (x[(inner < radii) & (radii < SHELL_RADII[1])] for x in (points, radii))
    rgb = torch.rand(points.shape, generator=random)
    sigma = density * ((lowest < radii) & (radii < highest))
    return Cloud(points, sigma, rgb, radius * SPACING, 0.01)


def make_rays(count: int) -> Rays:
    """From a sphere of radius 3 towards places within the shell."""
    random = torch.Generator().manual_seed(1)
    origins, targets = (
        torch.nn.functional.normalize(torch.randn(count, 3, generator=random), dim=1)
        for _ in range(2)
    )
    origins, targets = 3 * origins, 0.5 * targets
    directions = torch.nn.functional.normalize(targets - origins, dim=1)
    return Rays(origins, directions, torch.rand(count, generator=random))


def unit_box() -> tuple[Tensor, Tensor]:
    return -torch.ones(3), torch.ones(3)


def samples_in_box(batch: Rays) -> tuple[Tensor, Tensor]:
    return sample_distances(batch.origins, batch.directions, batch.offsets, *unit_box(), SPACING)


def compiled_renderer(
    point_cloud: Cloud,
    *,
    skipping: bool = True,
    is_occupied: Tensor | None = None,
    reading: InterpolationReading = READING,
    lattice: bool = False,
) -> RenderFunction:
    """The kernels; `skipping` space without a point, or without one that is `filled`.

    Points of a `lattice` are looked up, not searched.
    """
    points = PointGrid(point_cloud.positions, point_cloud.radius, NEIGHBORS, reading)
    points.cells.is_grid_aligned = lattice
    if is_occupied is not None:
        points.update_occupancy(is_occupied[points.order])
    if not skipping:
        points._distance_to_occupied.zero_()
    renderer = CompiledRenderer(points, (-1.0,) * 3, (1.0,) * 3, SPACING, point_cloud.stop)

    def render(batch: Rays, sigma: Tensor, rgb: Tensor) -> Tensor:
        output = renderer.render(batch, sigma[points.order], rgb[points.order])
        return output.composite_over(torch.ones(len(batch), 3))

    return render


def reference_render(point_cloud: Cloud) -> RenderFunction:
    options = {"step": SPACING, "radius": point_cloud.radius, "k": NEIGHBORS, "weights": READING}

    def render(batch: Rays, sigma: Tensor, rgb: Tensor) -> Tensor:
        geometry = (
            batch.origins,
            batch.directions,
            batch.offsets,
            *unit_box(),
            point_cloud.positions,
        )
        white = torch.ones(len(batch), 3)
        return render_reference(
            *geometry, sigma, rgb, white, **options, early_stop_transmittance=point_cloud.stop
        ).rgb

    return render


def kdtree_render(point_cloud: Cloud) -> RenderFunction:
    tree = cKDTree(point_cloud.positions.numpy())

    def render(batch: Rays, sigma: Tensor, rgb: Tensor) -> Tensor:
        t, in_box = samples_in_box(batch)
        positions = (batch.origins[:, None] + t[:, :, None] * batch.directions[:, None])[in_box]
        neighbor_distances, neighbor_ids = tree.query(
            positions.numpy(), NEIGHBORS, distance_upper_bound=point_cloud.radius
        )
        distance = torch.full((*t.shape, NEIGHBORS), torch.inf)
        distance[in_box] = torch.from_numpy(neighbor_distances).float()
        ids = torch.full((*t.shape, NEIGHBORS), -1)
        ids[in_box] = torch.from_numpy(np.where(np.isfinite(neighbor_distances), neighbor_ids, -1))
        weights = inverse_distance_weights(distance, point_cloud.radius, READING)
        field = Samples(t, ids, weights).mean(torch.cat([sigma[:, None], rgb], dim=1))
        density = terminated_density(field[..., 0], SPACING, point_cloud.stop)
        remaining = transmittance(density, SPACING)
        sample_weights = remaining[:, :-1] * opacities(density, SPACING)
        return (sample_weights[:, :, None] * field[..., 1:]).sum(dim=1) + remaining[:, -1:]

    return render


def time_render(render: RenderFunction, point_cloud: Cloud, batch: Rays) -> np.ndarray:
    """Nanoseconds a sample, forward and backward."""
    sigma, rgb = (x.clone().requires_grad_() for x in (point_cloud.sigma, point_cloud.rgb))
    times = [process_time()]
    loss = (render(batch, sigma, rgb) ** 2).mean()
    times.append(process_time())
    loss.backward()
    times.append(process_time())
    return 1e9 * np.diff(times) / int(samples_in_box(batch)[1].sum())


def median_times(variants: dict[Any, tuple[RenderFunction, Cloud, Rays]]) -> dict[Any, np.ndarray]:
    """The median of TURNS for each, after one that compiles."""
    for variant in variants.values():
        time_render(*variant)
    turns = [[time_render(*variant) for variant in variants.values()] for _ in range(REPEATS)]
    return dict(zip(variants, np.median(turns, axis=0), strict=True))


def compare_renderers(radii: list[float]) -> Table:
    heads = "radius", "density", "way", "forward ns", "backward ns", "times", "off by"
    table = Table(*heads, title=f"a sample; {len(make_cloud(1, 1).positions)} points, {RAYS} rays")
    for radius in radii:
        for name, density in DENSITY.items():
            point_cloud = make_cloud(radius, density)
            all_rays = make_rays(RAYS)
            few_rays = make_rays(REFERENCE_RAYS)
            renderers = {
                "kernels": compiled_renderer(point_cloud),
                "k-d tree": kdtree_render(point_cloud),
                "twin": reference_render(point_cloud),
            }
            times_by_renderer = median_times(
                {
                    name_of_renderer: (
                        render,
                        point_cloud,
                        few_rays if name_of_renderer == "twin" else all_rays,
                    )
                    for name_of_renderer, render in renderers.items()
                }
            )
            pixels = {
                name_of_renderer: render(few_rays, point_cloud.sigma, point_cloud.rgb)
                for name_of_renderer, render in renderers.items()
            }
            for name_of_renderer, (forward, backward) in times_by_renderer.items():
                ratio = (forward + backward) / sum(times_by_renderer["kernels"])
                max_error = (pixels[name_of_renderer] - pixels["twin"]).abs().max().item()
                cells = f"{forward:.1f}", f"{backward:.1f}", f"{ratio:.1f}", f"{max_error:.0e}"
                table.add_row(f"{radius:g}", name, name_of_renderer, *cells)
    return table


def measure_savings(radii: list[float]) -> Table:
    heads = "radius", "points", "rays end", "skipped", "forward ns", "backward ns"
    table = Table(*heads, title="a sample, opaque: what skipping and ending early save")
    for radius in radii:
        for ball in (False, True):
            full_cloud, variants = make_cloud(radius, DENSITY["opaque"], ball=ball), {}
            for ends, stop in {"early": 0.01, "never": 0.0}.items():
                point_cloud, batch = (
                    replace(full_cloud, early_stop_transmittance=stop),
                    make_rays(RAYS),
                )
                variants[ends, "nothing"] = (
                    compiled_renderer(point_cloud, skipping=False),
                    point_cloud,
                    batch,
                )
                variants[ends, "without points"] = (
                    compiled_renderer(point_cloud),
                    point_cloud,
                    batch,
                )
                if ball:
                    occupied_renderer = compiled_renderer(
                        point_cloud, is_occupied=point_cloud.sigma > 0
                    )
                    variants[ends, "without density"] = occupied_renderer, point_cloud, batch
            name = f"{len(full_cloud.positions)}, {'ball' if ball else 'shell'}"
            for variant, times in median_times(variants).items():
                table.add_row(f"{radius:g}", name, *variant, *(f"{time:.1f}" for time in times))
    return table


def compare_lattice() -> Table:
    heads = "density", "points are", "forward ns", "backward ns", "times"
    table = Table(*heads, title="a sample, tents")
    for name, density in DENSITY.items():
        point_cloud, batch = make_cloud(1.0, density, jittered=False), make_rays(RAYS)
        renderers = {
            "searched": compiled_renderer(point_cloud, reading="trilinear"),
            "looked up": compiled_renderer(point_cloud, reading="trilinear", lattice=True),
        }
        times_by_renderer = median_times(
            {lookup: (render, point_cloud, batch) for lookup, render in renderers.items()}
        )
        for lookup, (forward, backward) in times_by_renderer.items():
            ratio = (forward + backward) / sum(times_by_renderer["looked up"])
            table.add_row(name, lookup, f"{forward:.1f}", f"{backward:.1f}", f"{ratio:.2f}")
    return table


def main(radii: list[float]) -> None:
    torch.set_num_threads(1)
    console = Console(width=110)
    console.print(compare_renderers(radii))
    console.print(measure_savings(radii))
    console.print(compare_lattice())


if __name__ == "__main__":
    main([float(argument) for argument in sys.argv[1:]] or [0.9, 1.2])
