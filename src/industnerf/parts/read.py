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
CHORD, ANGLE = 5e-4, 0.25  # tessellation: share of the size, radians


def read_cad(
    path: Path, units: str
) -> tuple[Float[np.ndarray, "n 3"], Int[np.ndarray, "m 3"], int]:
    """Vertices in mm, faces, and the number of bodies in the file.

    `units` are those of a file that states none.  Raises BadPart that names the file and says
    what is wrong if it cannot be read or holds no face.
    """
    suffix = path.suffix.lower()
    if suffix in STEP and find_spec("cascadio") is None:
        raise BadPart(f"{path.name}: STEP needs the CAD extra: pip install -e '.[cad]'")
    import trimesh

    tessellation = (
        {"tol_linear": CHORD, "tol_angular": ANGLE, "tol_relative": True} if suffix in STEP else {}
    )
    try:
        scene = trimesh.load_scene(path, process=False, **tessellation)
        bodies = [m for m in scene.dump() if isinstance(m, trimesh.Trimesh) and len(m.faces)]
    except Exception as error:  # readers raise whatever their parser met
        raise BadPart(f"{path.name}: not readable as {suffix}: {error}") from None
    if not bodies:
        raise BadPart(f"{path.name}: no face in the file; it is empty, cut short or no solid")
    first = np.cumsum([0] + [len(body.vertices) for body in bodies[:-1]])
    vertices = np.concatenate([body.vertices for body in bodies]).astype(np.float64)
    faces = np.concatenate([b.faces + at for b, at in zip(bodies, first, strict=True)])
    scale = MM["m"] if suffix in IN_METRES else MM[units]
    return vertices * scale, faces.astype(np.int64), len(bodies)
