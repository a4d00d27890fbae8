"""One CAD file to its solids in mm: as the file has them, not yet cleaned.

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
from industnerf.parts.reading import formats
from industnerf.parts.reading.collada_files import read_dae, read_zae
from industnerf.parts.reading.content import Content
from industnerf.parts.reading.formats import Format, recognise
from industnerf.parts.reading.gltf import read_glb, read_gltf
from industnerf.parts.reading.obj import read_obj
from industnerf.parts.reading.off import read_off
from industnerf.parts.reading.paint import finishes_of
from industnerf.parts.reading.ply import read_ply
from industnerf.parts.reading.precision import precision_remarks
from industnerf.parts.reading.stl import read_stl
from industnerf.parts.reading.threedxml import read_threedxml
from industnerf.parts.reading.threemf import read_threemf
from industnerf.parts.units import MM

MESHES: dict[Format, Callable[[Path], Content]] = {
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
MOST_SAID = 300  # characters of a library's own message
FORGOTTEN = "string or file could not be read to its end"  # numpy's, where text is no number


def write_solids(path: Path, units: str, target: Path) -> None:
    """Read the file at `path` into the folder `target`; raises as `read_solids`."""
    read_solids(path, units).save(target)


def read_solids(path: Path, units: str) -> Solids:
    """The solids of the file at `path`.

    `units` (mm, cm, m or inch) are those of a file that states none.  Raises BadPart that names
    the file and says what is wrong, if it cannot be read or holds no face.
    """
    try:
        form, remarks = recognise(path)
        label, content = _read(path, form)
        return _solids(path.name, label, content, units, remarks)
    except BadPart as error:
        sentence = " ".join(str(error).split())  # libraries break theirs into lines
        raise BadPart(f"{path.name}: {sentence}") from None


def _read(path: Path, form: Format) -> tuple[str, Content]:
    try:
        with np.errstate(all="ignore"), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the libraries' own; what matters is a remark
            warnings.filterwarnings("error", message=FORGOTTEN)
            if form == formats.STL:
                return read_stl(path)
            return form.name, MESHES[form](path) if form in MESHES else _kernel(path, form)
    except (BadPart, MemoryError):
        raise
    except Exception as error:  # libraries raise whatever their parser met
        said = f"{type(error).__name__}: {error}"[:MOST_SAID]
        raise BadPart(f"not readable as {form.name}: {said}") from None


def _kernel(path: Path, form: Format) -> Content:
    if find_spec("OCP") is None:
        raise BadPart(
            f"{form.name} needs the CAD kernel, which is not installed: pip install -e '.[cad]'"
        )
    from industnerf.parts.reading import kernel

    readers = {formats.STEP: kernel.read_step, formats.IGES: kernel.read_iges}
    return readers.get(form, kernel.read_brep)(path)


def _solids(
    file: str, label: str, content: Content, units: str, remarks: tuple[str, ...]
) -> Solids:
    bodies = tuple(body for body in content.bodies if len(body.faces))
    if not bodies:
        said = "".join(f"; {remark}" for remark in content.remarks)
        raise BadPart(f"{label}: no face in the file: it is empty, or holds no surface{said}")
    if not any(np.isfinite(body.vertices[body.faces]).all(axis=(1, 2)).any() for body in bodies):
        raise BadPart(f"{label}: no face has three finite corners")
    precise = precision_remarks(bodies) if content.single else ()
    finishes, finish, lost = finishes_of(bodies)
    scale = MM[units] if content.scale is None else content.scale
    solids = tuple(
        Solid(body.name, Mesh(scale * body.vertices, body.faces.astype(np.int32), painted))
        for body, painted in zip(bodies, finish, strict=True)
    )
    unit = f"{units}, assumed" if content.unit is None else f"{content.unit}, stated"
    all_remarks = (*remarks, *content.remarks, *precise, *lost)
    return Solids(file, label, unit, finishes, all_remarks, solids)
