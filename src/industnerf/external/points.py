"""A cloud file of anybody's to points in mm."""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.cloud import Cloud, save_warnings
from industnerf.artifacts.part import load_mesh, load_part
from industnerf.errors import BadArtifact, BadPart
from industnerf.external.cloud_content import CloudContent, check_points, drop_transparent
from industnerf.external.converters import converter_hint
from industnerf.external.density import density_warnings
from industnerf.external.input_warnings import input_warnings
from industnerf.external.meshes import read_mesh
from industnerf.external.npz import read_npy, read_npz
from industnerf.external.pcd import read_pcd
from industnerf.external.xyz import read_xyz
from industnerf.seeds import generator

TEXT_SUFFIXES = (".xyz", ".csv", ".txt", ".pts", ".asc")
CLOUD_READERS = {".npz": read_npz, ".npy": read_npy, ".pcd": read_pcd} | dict.fromkeys(
    TEXT_SUFFIXES, read_xyz
)


def import_points(
    file: Path, part: Path, cap: int, compared: int, min_opacity: float, seed: int, target: Path
) -> None:
    """Write the points of `file` as the cloud of the folder `part` into the folder `target`.

    Of a mesh `cap` are drawn: as many as count of any cloud; `compared` is how many are.
    Gaussian splats below `min_opacity` are left out.  Raises BadArtifact that names the file if
    it holds no points.
    """
    rng = generator(seed, "outside", part.name)
    mesh, is_user_cad = load_mesh(part), load_part(part).origin == "file"
    content = choose_axes(read_cloud(file, cap, rng, min_opacity), mesh.vertices)
    points = content.points
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
    warnings = input_warnings(points, mesh.vertices, is_user_cad)
    if not warnings and not content.num_faces:  # elsewhere or otherwise sized, nothing is to be had
        warnings = density_warnings(points, mesh, compared, generator(seed, "density", part.name))
    save_warnings(target, [*content.warnings, *warnings])


def read_cloud(
    file: Path, cap: int, rng: np.random.Generator, min_opacity: float = 0.0
) -> CloudContent:
    """The points of a cloud, or `cap` of a mesh, drawn evenly by area; and remarks on the file.

    Rows that are not finite are left out, as are Gaussian splats below `min_opacity`.
    Raises BadArtifact that names the file if it cannot be read, or holds no point that is finite
    as float32.
    """
    try:
        return check_points(drop_transparent(_read(file, cap, rng), min_opacity))
    except BadPart as error:
        raise BadArtifact(f"{file} cannot be read: {error}") from None
    except Exception as error:  # the libraries raise whatever their parsers meet
        raise BadArtifact(f"{file} cannot be read: {type(error).__name__}: {error}") from None


def _read(file: Path, cap: int, rng: np.random.Generator) -> CloudContent:
    if hint := converter_hint(file):
        raise BadPart(hint)
    reader = CLOUD_READERS.get(file.suffix.lower())
    return reader(file) if reader else read_mesh(file, cap, rng)


def choose_axes(content: CloudContent, truth: Float[np.ndarray, "m 3"]) -> CloudContent:
    """Points in the axes of the file where those fit the part, and turned from y to z up do not.

    Of glTF, which has y up by its standard: programs that know nothing of it write their own axes.
    """
    if content.own_axes is None or not input_warnings(content.points, truth):
        return content
    if input_warnings(content.own_axes, truth):
        return content
    own = CloudContent(**vars(content) | {"points": content.own_axes, "own_axes": None})
    return own.warn("its axes are taken as they stand, which fits; glTF's standard has y up")
