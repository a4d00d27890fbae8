"""CAD and mesh files to one triangle soup in mm."""

from importlib.util import find_spec
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from industnerf.errors import BadPart

STEP = (".step", ".stp")
IN_METRES = (*STEP, ".glb", ".gltf")  # by their standard, or by the reader's output
SUFFIXES = (*STEP, ".stl", ".ply", ".obj", ".off", ".glb", ".gltf")
MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "inch": 25.4}
CHORD, ANGLE = 5e-4, 0.25  # tessellation: share of the diagonal, radians


def read_cad(path: Path, units: str) -> tuple[Float[np.ndarray, "n 3"], Int[np.ndarray, "m 3"]]:
    """Vertices in mm, and faces.

    `units` are those of a file that states none.  Raises BadPart that names the file and says
    what is wrong if it cannot be read or holds no face.
    """
    suffix = path.suffix.lower()
    if suffix in STEP and find_spec("cascadio") is None:
        raise BadPart(f"{path.name}: STEP needs the CAD extra: pip install -e '.[cad]'")
    try:
        meshes = _read_step(path) if suffix in STEP else _read(path)
    except Exception as error:  # readers raise whatever their parser met
        raise BadPart(f"{path.name}: not readable as {suffix}: {error}") from None
    if not meshes:
        raise BadPart(f"{path.name}: no face in the file; it is empty, cut short or no solid")
    first = np.cumsum([0] + [len(vertices) for vertices, _ in meshes[:-1]])
    vertices = np.concatenate([vertices for vertices, _ in meshes]).astype(np.float64)
    faces = np.concatenate([faces + at for (_, faces), at in zip(meshes, first, strict=True)])
    scale = MM["m"] if suffix in IN_METRES else MM[units]
    return vertices * scale, faces.astype(np.int64)


def _read_step(path: Path) -> list[tuple[np.ndarray, np.ndarray]]:
    """Twice: coarsely for the size (the reader's tolerance is absolute, in mm), then finely."""
    coarse = _read(path, tol_linear=1.0, tol_angular=0.5, merge_primitives=False)
    if not coarse:
        return []
    points = np.concatenate([vertices for vertices, _ in coarse]) * MM["m"]
    chord = CHORD * float(np.linalg.norm(np.ptp(points, axis=0)))
    return _read(path, tol_linear=chord, tol_angular=ANGLE, merge_primitives=False)


def _read(path: Path, **options: float | bool) -> list[tuple[np.ndarray, np.ndarray]]:
    """Vertices, in the file's unit, and faces of every mesh in the file, placed in the scene."""
    import trimesh

    scene = trimesh.load_scene(path, process=False, **options)
    meshes = [body for body in scene.dump() if isinstance(body, trimesh.Trimesh)]
    return [(np.asarray(m.vertices), np.asarray(m.faces)) for m in meshes if len(m.faces)]
