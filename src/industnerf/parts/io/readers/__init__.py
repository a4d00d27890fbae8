"""One CAD file to its solids in mm: as the file has them, not yet repaired.

Where a format says which way is up (glTF, COLLADA), the part is turned to z up; all others stay as
they are in the file.  Every refusal is a BadPart of one sentence; a file that hangs, crashes the
kernel or eats memory is the runner's to end.
"""

import warnings
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from industnerf.artifacts.part import Mesh
from industnerf.artifacts.solids import Solid, Solids
from industnerf.errors import BadPart
from industnerf.parts.io.readers import formats
from industnerf.parts.io.readers.collada import read_dae, read_zae
from industnerf.parts.io.readers.colors import quantize_finishes
from industnerf.parts.io.readers.formats import Format, detect_format
from industnerf.parts.io.readers.gltf import read_glb, read_gltf
from industnerf.parts.io.readers.mesh_content import MeshContent, precision_warnings
from industnerf.parts.io.readers.obj import read_obj
from industnerf.parts.io.readers.off import read_off
from industnerf.parts.io.readers.ply import read_ply
from industnerf.parts.io.readers.stl import read_stl
from industnerf.parts.io.readers.threedxml import read_threedxml
from industnerf.parts.io.readers.threemf import read_threemf
from industnerf.parts.io.units import MM_PER_UNIT

MESH_READERS: dict[Format, Callable[[Path], MeshContent]] = {
    formats.OBJ: read_obj,
    formats.PLY: read_ply,
    formats.OFF: read_off,
    formats.GLB: read_glb,
    formats.GLTF: read_gltf,
    formats.THREEMF: read_threemf,
    formats.DAE: read_dae,
    formats.ZAE: read_zae,
    formats.THREEDXML: read_threedxml,
}
MAX_MESSAGE_CHARS = 300  # characters of a library's own message
UNPARSED_NUMBER_WARNING = (
    "string or file could not be read to its end"  # numpy's, where text is no number
)


def write_solids(path: Path, units: str, target: Path) -> None:
    """Read the file at `path` into the folder `target`; raises as `read_solids`."""
    read_solids(path, units).save(target)


def read_solids(path: Path, units: str) -> Solids:
    """The solids of the file at `path`.

    `units` (mm, cm, m or inch) are those of a file that states none.  Raises BadPart that names
    the file and says what is wrong, if it cannot be read or holds no face.
    """
    try:
        file_format, format_warnings = detect_format(path)
        format_name, content = _read_content(path, file_format)
        return _to_solids(path.name, format_name, content, units, format_warnings)
    except BadPart as error:
        sentence = " ".join(str(error).split())  # libraries break theirs into lines
        raise BadPart(f"{path.name}: {sentence}") from None


def _read_content(path: Path, file_format: Format) -> tuple[str, MeshContent]:
    try:
        with np.errstate(all="ignore"), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the libraries' own; what matters is a warning
            warnings.filterwarnings("error", message=UNPARSED_NUMBER_WARNING)
            if file_format == formats.STL:
                return read_stl(path)
            return file_format.name, MESH_READERS[file_format](
                path
            ) if file_format in MESH_READERS else _read_with_occt(path, file_format)
    except (BadPart, MemoryError):
        raise
    except Exception as error:  # libraries raise whatever their parser met
        message = f"{type(error).__name__}: {error}"[:MAX_MESSAGE_CHARS]
        raise BadPart(f"not readable as {file_format.name}: {message}") from None


def _read_with_occt(path: Path, file_format: Format) -> MeshContent:
    if find_spec("OCP") is None:
        raise BadPart(
            f"{file_format.name} needs the CAD kernel, which is not installed: "
            "pip install -e '.[cad]'"
        )
    from industnerf.parts.io.readers import occt

    readers = {formats.STEP: occt.read_step, formats.IGES: occt.read_iges}
    return readers.get(file_format, occt.read_brep)(path)


def _to_solids(
    file: str, format_name: str, content: MeshContent, units: str, format_warnings: tuple[str, ...]
) -> Solids:
    bodies = tuple(body for body in content.bodies if len(body.faces))
    if not bodies:
        hint = "".join(f"; {text}" for text in content.warnings)
        raise BadPart(f"{format_name}: no face in the file: it is empty, or holds no surface{hint}")
    if not any(np.isfinite(body.vertices[body.faces]).all(axis=(1, 2)).any() for body in bodies):
        raise BadPart(f"{format_name}: no face has three finite corners")
    float_warnings = precision_warnings(bodies) if content.is_float32 else ()
    finishes, finish, color_warnings = quantize_finishes(bodies)
    scale = MM_PER_UNIT[units] if content.scale is None else content.scale
    solids = tuple(
        Solid(body.name, Mesh(scale * body.vertices, body.faces.astype(np.int32), face_finish))
        for body, face_finish in zip(bodies, finish, strict=True)
    )
    unit = f"{units}, assumed" if content.unit is None else f"{content.unit}, stated"
    all_warnings = (*format_warnings, *content.warnings, *float_warnings, *color_warnings)
    return Solids(file, format_name, unit, finishes, all_warnings, solids)
