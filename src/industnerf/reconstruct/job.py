"""From the command line's options to files."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float
from rich.console import Console

from industnerf.artifacts.ply import write_ply
from industnerf.artifacts.whole import written_whole
from industnerf.geometry.cameras import Cameras
from industnerf.reconstruct.digits import check_digits
from industnerf.reconstruct.display import Display
from industnerf.reconstruct.gather import Album, gather
from industnerf.reconstruct.options import Options
from industnerf.reconstruct.outputs import check_apart, check_outputs
from industnerf.reconstruct.region import region
from industnerf.reconstruct.settings import choose
from industnerf.stage import measured


def reconstruct(options: Options, console: Console | None = None) -> None:
    """Do what `options` ask for; says what it does on `console`, by default the terminal."""
    check_outputs(options)
    with Display(console or Console()) as display:
        said: list[str] = []
        cost = measured(lambda out: said.append(_reconstruct(options, display)), options.out)
        display.say(f"{said[0]}; {cost.seconds:.1f} s, at most {cost.peak_mb:.0f} MB")


def _reconstruct(options: Options, display: Display) -> str:
    chosen = choose(options.method, options.overrides, options.params)
    if options.show:
        for line in chosen.lines():
            display.say(line)
    album = _read(options, display)
    check_apart(options, [chosen.source, *album.owned])
    centre, radius = region(album.cameras, album.photos, options.centre, options.radius)
    check_digits(centre, radius)
    display.say(
        f"{len(album.photos)} photographs of {album.cameras.width} x {album.cameras.height} px; "
        f"region of interest: centre {_listed(centre)}, radius {radius:.5g}"
    )
    from industnerf.reconstruct.work import work  # late: it takes torch, which wrong input does not

    outcome = work(options, album, centre, radius, chosen, display)
    write_cloud(options, outcome, album.photos)
    if options.mesh:
        display.say(f"{options.out} is written")  # whatever becomes of the mesh
        display.say(write_mesh(options.mesh, outcome, album.cameras, centre, radius))
    options.checkpoint.unlink(missing_ok=True)
    return (
        f"{options.out}: {len(outcome.points)} points, {outcome.steps} steps, "
        f"{outcome.parameters} parameters"
    )


def _read(options: Options, display: Display) -> Album:
    album = gather(
        options.cameras,
        options.images,
        longest=options.longest,
        background=options.background,
        every=options.every,
        tick=display.count,
    )
    for remark in album.remarks:
        display.say(remark)
    return album


def write_cloud(options: Options, outcome: Any, photos: Sequence[Path]) -> None:
    """Write the outcome as PLY and, if asked for, as NPZ with the files that `view` counts."""
    with written_whole(options.out) as draft:
        write_ply(
            draft,
            outcome.points,
            colours=outcome.colours,
            confidence=outcome.confidence,
            view=outcome.view,
            unit="the cameras' unit",
        )
    if options.npz:
        with written_whole(options.npz) as draft, draft.open("wb") as file:
            np.savez_compressed(
                file,
                points=outcome.points,
                colours=outcome.colours,
                confidence=outcome.confidence,
                view=outcome.view,
                photos=[str(photo) for photo in photos],
            )


def write_mesh(
    path: Path, outcome: Any, cameras: Cameras, centre: Float[np.ndarray, "3"], radius: float
) -> str:
    """Write the surface of the outcome as triangles; says what it is."""
    from industnerf.reconstruct import mesh  # late: it takes trimesh

    surface = mesh.surface(outcome, cameras, centre, radius)
    with written_whole(path) as draft:
        mesh.write(draft, surface, path.suffix.lower())
    return (
        f"{path}: {len(surface.faces)} triangles, area {surface.area:.5g}, volume "
        f"{surface.volume:.5g}, in the cameras' unit"
    )


def _listed(point: Float[np.ndarray, "3"]) -> str:
    return " ".join(f"{x:.5g}" for x in point)
