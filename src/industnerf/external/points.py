"""A cloud file of anybody's to points in mm."""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.cloud import Cloud, save_warnings
from industnerf.artifacts.part import load_mesh, load_part
from industnerf.errors import BadArtifact, BadPart
from industnerf.external.input_warnings import input_warnings
from industnerf.external.meshes import MAX_COORDINATE, read_mesh
from industnerf.external.npz import read_npz_points
from industnerf.external.xyz import read_xyz
from industnerf.seeds import generator


def import_points(file: Path, part: Path, cap: int, seed: int, target: Path) -> None:
    """Write the points of `file` as the cloud of the folder `part` into the folder `target`.

    Of a mesh `cap` are drawn: as many as count of any cloud.  Raises BadArtifact that names
    the file if it holds no points.
    """
    points, warnings = read_points(file, cap, generator(seed, "outside", part.name))
    count = len(points)
    Cloud(
        part.name,
        points.astype(np.float32),
        np.full((count, 3), 128, np.uint8),
        np.ones(count, np.float32),
        np.full(count, -1, np.int16),
        num_parameters=0,
        steps=0,
    ).save(target)
    is_user_cad = load_part(part).origin == "file"
    save_warnings(
        target, [*warnings, *input_warnings(points, load_mesh(part).vertices, is_user_cad)]
    )


def read_points(
    file: Path, cap: int, rng: np.random.Generator
) -> tuple[Float[np.ndarray, "n 3"], list[str]]:
    """The points of a cloud, or `cap` of a mesh, drawn evenly by area; and remarks on the file.

    Raises BadArtifact that names the file if it cannot be read, is empty, or is not finite as
    float32.
    """
    try:
        points, warnings = _read(file, cap, rng)
    except BadPart as error:
        raise BadArtifact(f"{file} cannot be read: {error}") from None
    except Exception as error:  # the libraries raise whatever their parsers meet
        raise BadArtifact(f"{file} cannot be read: {type(error).__name__}: {error}") from None
    points = np.asarray(points, np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise BadArtifact(f"{file}: points are of shape {points.shape}, must be n x 3")
    if not len(points):
        raise BadArtifact(f"{file}: no point in the file")
    if num_bad := int((~np.isfinite(points).all(axis=1)).sum()):
        raise BadArtifact(f"{file}: {num_bad} of {len(points)} points are not finite")
    if num_bad := int((np.abs(points) > MAX_COORDINATE).any(axis=1).sum()):
        raise BadArtifact(
            f"{file}: {num_bad} of {len(points)} points are too large: a coordinate of "
            f"{np.abs(points).max():.3g}, and float32 ends at {MAX_COORDINATE:.3g}"
        )
    return points, warnings


def _read(file: Path, cap: int, rng: np.random.Generator) -> tuple[np.ndarray, list[str]]:
    suffix = file.suffix.lower()
    if suffix == ".npz":
        return read_npz_points(file), []
    if suffix == ".xyz":
        return read_xyz(file)
    return read_mesh(file, cap, rng)
