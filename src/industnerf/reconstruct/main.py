"""From the command line's options to files."""

import shutil
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float
from rich.console import Console

from industnerf.artifacts.files import atomic_write, check_writable
from industnerf.artifacts.ply import write_ply
from industnerf.errors import BadArtifact, RegionInsteadOfPart
from industnerf.reconstruct.archives import named_in_archive, unpacked
from industnerf.reconstruct.cli import Options
from industnerf.reconstruct.display import Display
from industnerf.reconstruct.load_images import ImageSet, load_images
from industnerf.reconstruct.region import check_float32_precision, region_of_interest
from industnerf.reconstruct.result_check import (
    ResultShares,
    covered_share,
    no_part_warning,
    result_shares,
)
from industnerf.reconstruct.scale import Scale
from industnerf.reconstruct.settings import resolve_config
from industnerf.reconstruct.silhouette_check import (
    agree_once_transposed,
    plain_silhouettes,
    silhouette_warning,
    silhouettes_of,
    transpose_rotations,
)
from industnerf.reconstruct.sources import Selection
from industnerf.splats import save_preview
from industnerf.stage import run_timed

NO_OUTLINES = (
    "next to no photograph has a plain border, and there are no masks: industnerf_plus finds the "
    "part by its outline, so expect no part: cut it out (mask_path, or transparent pixels), or use "
    "--method industnerf"
)


def reconstruct(options: Options, console: Console | None = None) -> None:
    """Do what `options` ask for; says what it does on `console`, by default the terminal.

    Raises RegionInsteadOfPart, once all is written, if the result is no part.
    """
    check_outputs(options)
    with Display(console or Console()) as display:
        summaries: list[Summary] = []
        cost = run_timed(lambda out: summaries.append(_run(options, display)), options.out)
        display.log(f"{summaries[0].text}; {cost.seconds:.1f} s, at most {cost.peak_mb:.0f} MB")
    if summaries[0].shares.is_no_part:
        raise RegionInsteadOfPart(no_part_warning(summaries[0].shares))


@dataclass(frozen=True)
class Summary:
    """What was written, and what it is."""

    text: str
    shares: ResultShares


def _run(options: Options, display: Display) -> Summary:
    config = resolve_config(options.method, options.overrides, options.params)
    if options.print_config:
        for line in config.format_lines():
            display.log(line)
    image_set = _check_silhouettes(options, _load_image_set(options, display), display)
    check_not_inputs(options, [config.source, *image_set.protected_paths])
    center, radius = image_set.center, image_set.radius
    check_float32_precision(center, radius)
    display.log(
        f"{len(image_set.image_paths)} photographs of {image_set.cameras.width} x "
        f"{image_set.cameras.height} px; region of interest: "
        f"center {_format_point(center)}, radius {radius:.5g}"
    )
    from industnerf.reconstruct.run import (
        run_reconstruction,  # late: it takes torch, which wrong input does not
    )

    result = run_reconstruction(options, image_set, center, radius, config, display)
    write_cloud(options, result, image_set.image_paths)
    save_preview(Path(f"{options.out}.png"), result.points, result.colors)
    if options.mesh:
        display.log(f"{options.out} is written")  # whatever becomes of the mesh
        display.log(write_mesh(options, result, image_set))
    options.checkpoint.unlink(missing_ok=True)
    return Summary(
        f"{options.out}: {len(result.points)} points, {result.steps} steps, "
        f"{result.num_parameters} parameters",
        result_shares(
            result.points, result.view, center, radius, _covered(options, image_set, result)
        ),
    )


def _covered(options: Options, image_set: ImageSet, result: Any) -> float:
    """The share of the silhouettes that the result covers, where a method finds them by color.

    All of them, where the region is narrowed: they may show what is beside it.
    """
    has_masks = image_set.background is not None and options.background is None
    is_narrowed = options.center is not None or options.radius is not None
    if has_masks or is_narrowed or options.method != "industnerf_plus":
        return 1.0
    views = np.arange(len(image_set.rgb))
    silhouettes = silhouettes_of(views, image_set.rgb, image_set.cameras, result.background)
    background = result.background[silhouettes.views]
    return covered_share(
        silhouettes, result.render_views(silhouettes.cameras, background).foreground
    )


def _load_image_set(options: Options, display: Display) -> ImageSet:
    cameras = options.cameras or _find_cameras(options, display)
    with unpacked(cameras) as path:
        image_set = load_images(
            path,
            options.images,
            max_size=options.max_size,
            background=options.background,
            selection=_selection(options),
            center=options.center,
            radius=options.radius,
            on_image_loaded=display.count_images,
        )
    if path != cameras:
        image_set = named_in_archive(image_set, path, cameras)
    for warning in image_set.warnings:
        display.log(warning)
    return image_set


def _check_silhouettes(options: Options, image_set: ImageSet, display: Display) -> ImageSet:
    """`image_set`, its rotations transposed if it is COLMAP's and only so its silhouettes agree."""
    silhouettes = plain_silhouettes(image_set.rgb, image_set.cameras, image_set.background)
    if silhouettes is None:
        if image_set.background is None and options.method == "industnerf_plus":
            display.log(NO_OUTLINES)
        return image_set
    warning = silhouette_warning(silhouettes, image_set.center, image_set.radius, image_set.names)
    if warning is None:
        return image_set
    if not (image_set.is_colmap and agree_once_transposed(silhouettes)):
        display.log(warning)
        return image_set
    display.log(
        f"{options.cameras}: the quaternions lead from camera to world, and COLMAP's from world to "
        "camera: they are read so, as only then the photographs agree on where the part is"
    )
    cameras = replace(image_set.cameras, c2w=transpose_rotations(image_set.cameras.c2w))
    center, radius = region_of_interest(cameras, image_set.names, options.center, options.radius)
    return replace(image_set, cameras=cameras, center=center, radius=radius)


def _find_cameras(options: Options, display: Display) -> Path:
    from industnerf.reconstruct import sfm  # late: it takes pycolmap

    folder = Path(f"{options.out}.sfm")
    if options.no_resume:
        shutil.rmtree(folder, ignore_errors=True)
    display.log(f"finding the cameras of the photographs in {options.images}: minutes")
    model, sentence = sfm.find_cameras(options.images, folder)
    display.log(sentence)
    return model


def _selection(options: Options) -> Selection:
    return Selection(
        options.all_frames,
        options.exclude,
        options.strict,
        options.ignore_masks,
        options.undo_transform,
        options.scale and Scale(options.scale[:2], options.scale[2]),
    )


def _unit(options: Options) -> str:
    """In which lengths are, for a message."""
    return "mm" if options.scale else "the cameras' unit"


def write_cloud(options: Options, result: Any, image_paths: Sequence[Path]) -> None:
    """Write the result as PLY and, if asked for, as NPZ with the files that `view` counts."""
    with atomic_write(options.out) as draft:
        write_ply(
            draft,
            result.points,
            colors=result.colors,
            confidence=result.confidence,
            view=result.view,
            unit=_unit(options),
        )
    if options.npz:
        with atomic_write(options.npz) as draft, draft.open("wb") as file:
            np.savez_compressed(
                file,
                points=result.points,
                colors=result.colors,
                confidence=result.confidence,
                view=result.view,
                image_paths=[str(image_path) for image_path in image_paths],
            )


def write_mesh(options: Options, result: Any, image_set: ImageSet) -> str:
    """Write the surface of the result as triangles; returns a sentence on it."""
    from industnerf.reconstruct import mesh, mesh_pieces  # late: they take trimesh

    path = options.mesh
    triangle_mesh = mesh.extract_mesh(result, image_set.cameras, image_set.center, image_set.radius)
    pieces = mesh_pieces.split_pieces(triangle_mesh)
    if options.mesh_pieces:
        triangle_mesh = mesh_pieces.keep_largest(triangle_mesh, pieces, options.mesh_pieces)
    with atomic_write(path) as draft:
        mesh.export_mesh(draft, triangle_mesh, path.suffix.lower(), _unit(options))
    return (
        f"{path}: {len(triangle_mesh.faces)} triangles, area {triangle_mesh.area:.5g}, volume "
        f"{triangle_mesh.volume:.5g}, in {_unit(options)}; "
        f"{mesh_pieces.pieces_sentence(pieces, options.mesh_pieces)}"
    )


def _format_point(point: Float[np.ndarray, "3"]) -> str:
    return " ".join(f"{x:.5g}" for x in point)


def check_outputs(options: Options) -> None:
    """Raise BadArtifact if a file is in the way, or cannot be written, before any work is done."""
    outputs = _output_paths(options)
    if len({path.resolve() for path in outputs.values()}) < len(outputs):
        raise BadArtifact(f"{', '.join(outputs)} must be different files")
    check_not_inputs(options, [options.cameras] if options.cameras else [])
    overwritten = [path for path in (options.out, options.npz, options.mesh) if path]
    is_resuming = (
        options.checkpoint.exists() and not options.no_resume
    )  # then the preview is its own
    if options.has_explicit_preview and options.preview_every and not is_resuming:
        overwritten.append(options.preview)
    for path in overwritten:
        if path.exists() and not (options.force or path.is_dir()):
            raise BadArtifact(f"{path} is there already; --force overwrites it")
    for option, path in outputs.items():
        check_writable(path, option)


def check_not_inputs(options: Options, inputs: Iterable[Path]) -> None:
    """Raise BadArtifact if an output is one of `inputs`: --force is no leave to destroy those."""
    input_ids = {_file_id(path) for path in inputs}
    for option, path in _output_paths(options).items():
        if _file_id(path) in input_ids:
            raise BadArtifact(
                f"{option} {path}: is an input of this run, which not even --force overwrites; "
                "name another file"
            )


def _output_paths(options: Options) -> dict[str, Path]:
    """Every file that will be written, by the option that says where."""
    outputs = {"--out": options.out, "--checkpoint": options.checkpoint}
    outputs |= {"--preview": options.preview} if options.preview_every else {}
    outputs |= {"--npz": options.npz} if options.npz else {}
    return outputs | ({"--mesh": options.mesh} if options.mesh else {})


def _file_id(path: Path) -> object:
    """Equal for two names of one file, be it by a link or on a disk that ignores case."""
    try:
        stat = path.stat()
    except OSError:
        return path.resolve()
    return stat.st_dev, stat.st_ino
