"""From the command line's options to files."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float
from rich.console import Console

from industnerf.artifacts.files import atomic_write
from industnerf.artifacts.ply import write_ply
from industnerf.geometry.cameras import Cameras
from industnerf.reconstruct.cli import Options
from industnerf.reconstruct.display import Display
from industnerf.reconstruct.float_precision import check_float32_precision
from industnerf.reconstruct.load_images import ImageSet, load_images
from industnerf.reconstruct.outputs import check_not_inputs, check_outputs
from industnerf.reconstruct.region import region_of_interest
from industnerf.reconstruct.settings import resolve_config
from industnerf.stage import run_timed


def reconstruct(options: Options, console: Console | None = None) -> None:
    """Do what `options` ask for; says what it does on `console`, by default the terminal."""
    check_outputs(options)
    with Display(console or Console()) as display:
        summaries: list[str] = []
        cost = run_timed(lambda out: summaries.append(_run(options, display)), options.out)
        display.log(f"{summaries[0]}; {cost.seconds:.1f} s, at most {cost.peak_mb:.0f} MB")


def _run(options: Options, display: Display) -> str:
    config = resolve_config(options.method, options.overrides, options.params)
    if options.print_config:
        for line in config.format_lines():
            display.log(line)
    image_set = _load_image_set(options, display)
    check_not_inputs(options, [config.source, *image_set.protected_paths])
    center, radius = region_of_interest(
        image_set.cameras, image_set.image_paths, options.center, options.radius
    )
    check_float32_precision(center, radius)
    display.log(
        f"{len(image_set.image_paths)} photographs of {image_set.cameras.width} x {image_set.cameras.height} px; "
        f"region of interest: center {_format_point(center)}, radius {radius:.5g}"
    )
    from industnerf.reconstruct.run import (
        run_reconstruction,  # late: it takes torch, which wrong input does not
    )

    result = run_reconstruction(options, image_set, center, radius, config, display)
    write_cloud(options, result, image_set.image_paths)
    if options.mesh:
        display.log(f"{options.out} is written")  # whatever becomes of the mesh
        display.log(write_mesh(options.mesh, result, image_set.cameras, center, radius))
    options.checkpoint.unlink(missing_ok=True)
    return (
        f"{options.out}: {len(result.points)} points, {result.steps} steps, "
        f"{result.num_parameters} parameters"
    )


def _load_image_set(options: Options, display: Display) -> ImageSet:
    image_set = load_images(
        options.cameras,
        options.images,
        max_size=options.max_size,
        background=options.background,
        all_frames=options.all_frames,
        on_image_loaded=display.count_images,
    )
    for warning in image_set.warnings:
        display.log(warning)
    return image_set


def write_cloud(options: Options, result: Any, image_paths: Sequence[Path]) -> None:
    """Write the outcome as PLY and, if asked for, as NPZ with the files that `view` counts."""
    with atomic_write(options.out) as draft:
        write_ply(
            draft,
            result.points,
            colors=result.colors,
            confidence=result.confidence,
            view=result.view,
            unit="the cameras' unit",
        )
    if options.npz:
        with atomic_write(options.npz) as draft, draft.open("wb") as file:
            np.savez_compressed(
                file,
                points=result.points,
                colors=result.colors,
                confidence=result.confidence,
                view=result.view,
                photos=[str(image_path) for image_path in image_paths],
            )


def write_mesh(
    path: Path, result: Any, cameras: Cameras, center: Float[np.ndarray, "3"], radius: float
) -> str:
    """Write the surface of the outcome as triangles; says what it is."""
    from industnerf.reconstruct import mesh  # late: it takes trimesh

    triangle_mesh = mesh.extract_mesh(result, cameras, center, radius)
    with atomic_write(path) as draft:
        mesh.export_mesh(draft, triangle_mesh, path.suffix.lower())
    return (
        f"{path}: {len(triangle_mesh.faces)} triangles, area {triangle_mesh.area:.5g}, volume "
        f"{triangle_mesh.volume:.5g}, in the cameras' unit"
    )


def _format_point(point: Float[np.ndarray, "3"]) -> str:
    return " ".join(f"{x:.5g}" for x in point)
