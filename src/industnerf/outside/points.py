"""A cloud file of anybody's to points in mm, and what looks odd about them."""

from pathlib import Path

import numpy as np
import trimesh
from jaxtyping import Float

from industnerf.artifacts.cloud import Cloud, save_remarks
from industnerf.artifacts.part import load_mesh
from industnerf.errors import BadArtifact
from industnerf.geometry.sampling import sample_surface
from industnerf.seeds import generator

SIDES = 0.05  # of the diagonal, by which sides of boxes may differ that are the same
NAMES = ("points_mm", "points")  # of the suite's stages, and of `industnerf.reconstruct --npz`
ALIKE = (0.5, 2.0)  # ratio of the boxes' diagonals beyond which a unit is wrong, most likely


def take_over(file: Path, part: Path, cap: int, seed: int, target: Path) -> None:
    """Write the points of `file` as the cloud of the folder `part` into the folder `target`.

    Of a mesh `cap` are drawn: as many as count of any cloud.  Raises BadArtifact that names
    the file if it holds no points.
    """
    points = read_points(file, cap, generator(seed, "outside", part.name)).astype(np.float32)
    count = len(points)
    Cloud(
        part.name,
        points,
        np.full((count, 3), 128, np.uint8),
        np.ones(count, np.float32),
        np.full(count, -1, np.int16),
        parameters=0,
        steps=0,
    ).save(target)
    save_remarks(target, oddities(points, load_mesh(part).vertices))


def read_points(file: Path, cap: int, rng: np.random.Generator) -> Float[np.ndarray, "n 3"]:
    """The points of a cloud; of a mesh, `cap` drawn evenly by area.

    Raises BadArtifact that names the file if it cannot be read, is empty, or is not finite.
    """
    points = np.asarray(_points(file, cap, rng), np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise BadArtifact(f"{file}: points are of shape {points.shape}, must be n x 3")
    if not len(points):
        raise BadArtifact(f"{file}: no point in the file")
    if bad := int((~np.isfinite(points).all(axis=1)).sum()):
        raise BadArtifact(f"{file}: {bad} of {len(points)} points are not finite")
    return points


def _points(file: Path, cap: int, rng: np.random.Generator) -> np.ndarray:
    try:
        if file.suffix.lower() == ".npz":
            return _array(file)
        read = trimesh.load(file, process=False)
    except Exception as error:  # trimesh and zipfile raise whatever their parsers meet
        raise BadArtifact(f"{file} cannot be read: {type(error).__name__}: {error}") from None
    meshes = [one for one in _members(read) if isinstance(one, trimesh.Trimesh) and len(one.faces)]
    if meshes:
        whole = trimesh.util.concatenate(meshes)
        return sample_surface(np.asarray(whole.vertices), np.asarray(whole.faces), cap, rng)[0]
    return np.concatenate([np.zeros((0, 3)), *(one.vertices for one in _members(read))])


def _array(file: Path) -> np.ndarray:
    with np.load(file, allow_pickle=False) as arrays:
        for name in NAMES:
            if name in arrays:
                return arrays[name]
        raise ValueError(f"it holds none of {', '.join(NAMES)}, only {', '.join(arrays)}")


def _members(read: object) -> list:
    return list(read.dump()) if isinstance(read, trimesh.Scene) else [read]


def oddities(points: Float[np.ndarray, "n 3"], truth: Float[np.ndarray, "m 3"]) -> list[str]:
    """What makes it likely that the unit or the frame is not the part's; both are in mm."""
    sides, wanted = np.ptp(points, axis=0), np.ptp(truth, axis=0)
    ratio = float(np.linalg.norm(sides) / np.linalg.norm(wanted))
    if not ALIKE[0] < ratio < ALIKE[1]:
        return [f"its box is {ratio:.3g} times as large as the part's: is it in mm?"]
    off = float(np.linalg.norm(points.mean(axis=0) - truth.mean(axis=0)) / np.linalg.norm(wanted))
    if off > 0.5:
        return [f"its middle is {off:.2g} diagonals from the part's: is it in the cameras' frame?"]
    if _alike(np.sort(sides), np.sort(wanted)) and not _alike(sides, wanted):
        return [
            "its sides are the part's in another order: are its axes those of the cameras' frame?"
        ]
    return []


def _alike(a: Float[np.ndarray, "3"], b: Float[np.ndarray, "3"]) -> bool:
    return bool((np.abs(a - b) < SIDES * np.linalg.norm(b)).all())
