"""One CAD file to its solids in mm: as the file has them, not yet repaired.

Formats that name their up axis (glTF, COLLADA) are turned to z up.  A file that cannot be read
raises BadPart with one sentence.  The runner ends files that hang, crash the CAD kernel or eat
memory.
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
from industnerf.parts.io.units import ASSUMED, MM_PER_UNIT, OVERRIDDEN, STATED

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
UNPARSED_NUMBER_WARNING = "string or file could not be read to its end"  # numpy's


def write_solids(path: Path, units: str, target: Path, override_units: bool = False) -> None:
    """Read the file at `path` into the folder `target`; raises as `read_solids`."""
    read_solids(path, units, override_units).save(target)


def read_solids(path: Path, units: str, override_units: bool = False) -> Solids:
    """The solids of the file at `path`.

    `units` (mm, cm, m or inch) are those of a file that states none and, with `override_units`,
    of any.  Raises BadPart that names the file and says what is wrong, if it cannot be read or
    holds no face.
    """
    try:
        file_format, format_warnings = detect_format(path)
        format_name, content = _read_content(path, file_format)
        scale, unit = resolve_unit(content, units, override_units)
        return _to_solids(path.name, format_name, content, scale, unit, format_warnings)
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


def resolve_unit(content: MeshContent, units: str, override: bool) -> tuple[float, str]:
    """The mm in one unit of the coordinates, and the unit as `Solids` tells it.

    Raises BadPart if `units` are to override several that the file states.
    """
    if content.scale is None:
        return MM_PER_UNIT[units], units + ASSUMED
    factor = content.scale if not content.is_in_mm else MM_PER_UNIT.get(content.unit or "")
    if not override or factor == MM_PER_UNIT[units]:
        return content.scale, f"{content.unit}{STATED}"
    if not content.is_in_mm:
        return MM_PER_UNIT[units], units + OVERRIDDEN
    if content.unit not in MM_PER_UNIT:
        raise BadPart(
            f"it states {content.unit}, which {units} cannot override (parts.override_units)"
        )
    return MM_PER_UNIT[units] / MM_PER_UNIT[content.unit], units + OVERRIDDEN


def _to_solids(
    file: str,
    format_name: str,
    content: MeshContent,
    scale: float,
    unit: str,
    format_warnings: tuple[str, ...],
) -> Solids:
    bodies = tuple(body for body in content.bodies if len(body.faces))
    if not bodies:
        hint = "".join(f"; {text}" for text in content.warnings)
        reason = ": it is empty, or holds no surface"
        if content.num_points:
            reason = f", but {content.num_points} points: it is a cloud, no mesh"
        raise BadPart(f"{format_name}: no face in the file{reason}{hint}")
    if not any(np.isfinite(body.vertices[body.faces]).all(axis=(1, 2)).any() for body in bodies):
        raise BadPart(f"{format_name}: no face has three finite corners")
    float_warnings = precision_warnings(bodies) if content.is_float32 else ()
    finishes, finish, color_warnings = quantize_finishes(bodies)
    solids = tuple(
        Solid(body.name, Mesh(scale * body.vertices, body.faces.astype(np.int32), face_finish))
        for body, face_finish in zip(bodies, finish, strict=True)
    )
    all_warnings = (*format_warnings, *content.warnings, *float_warnings, *color_warnings)
    return Solids(file, format_name, unit, finishes, all_warnings, solids)
