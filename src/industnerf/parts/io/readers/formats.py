"""The format of a file: by its content, or by its name where the content does not tell."""

import re
import zipfile
from dataclasses import dataclass
from pathlib import Path

from industnerf.errors import BadPart

HEAD_BYTES = 1 << 16  # bytes looked at


@dataclass(frozen=True)
class Format:
    """A format that can be read."""

    name: str  # for people
    suffixes: tuple[str, ...]


STEP = Format("STEP", (".step", ".stp", ".p21"))
IGES = Format("IGES", (".iges", ".igs"))
BREP = Format("BREP", (".brep", ".brp"))
STL = Format("STL", (".stl",))
OBJ = Format("OBJ", (".obj",))
PLY = Format("PLY", (".ply",))
OFF = Format("OFF", (".off",))
GLB = Format("GLB", (".glb",))
GLTF = Format("glTF", (".gltf",))
THREEMF = Format("3MF", (".3mf",))
DAE = Format("COLLADA", (".dae",))
ZAE = Format("zipped COLLADA", (".zae",))
THREEDXML = Format("3DXML", (".3dxml",))
FORMATS = (STEP, IGES, BREP, STL, OBJ, PLY, OFF, GLB, GLTF, THREEMF, DAE, ZAE, THREEDXML)
SUFFIXES = {suffix: form for form in FORMATS for suffix in form.suffixes}
CLOUD_SUFFIXES = (".xyz", ".pcd", ".pts", ".ptx", ".asc", ".las", ".laz", ".e57")


def detect_format(path: Path) -> tuple[Format, tuple[str, ...]]:
    """The format of the file at `path`, and a warning where its name says another.

    Raises BadPart if the file cannot be opened or is empty, or if neither content nor name tells.
    """
    try:
        size = path.stat().st_size
        with path.open("rb") as file:
            head = file.read(HEAD_BYTES)
    except OSError as error:
        raise BadPart(f"cannot be opened: {error.strerror}") from None
    if not head:
        raise BadPart("the file is empty (0 bytes)")
    expected, detected = SUFFIXES.get(path.suffix.lower()), detect_by_content(path, head, size)
    if detected is None and path.suffix.lower() in CLOUD_SUFFIXES:
        raise BadPart(
            f"{path.suffix} is a cloud of points, which has no face and is no part; "
            "`python -m industnerf.view` shows it, `python -m pipeline.score` scores it"
        )
    if detected is None and expected is None:
        suffixes = ", ".join(sorted(SUFFIXES))
        raise BadPart(
            f"neither its content nor its name ({path.suffix or 'without a suffix'}) is of a "
            f"format that is read here: {suffixes}"
        )
    if detected is None or detected == expected:
        return expected or detected, ()
    return detected, (
        f"named {path.suffix or 'without a suffix'}, but its content is {detected.name}",
    )


def detect_by_content(path: Path, head: bytes, size: int) -> Format | None:
    """The format that the bytes tell, or None."""
    start = head.removeprefix(b"\xef\xbb\xbf").lstrip()
    if is_binary_stl(head, size):  # first, for its header may say anything
        return STL
    if head.startswith(b"glTF"):
        return GLB
    if head.startswith(b"PK\3\4"):
        return _detect_archived(path)
    if re.match(rb"ply\s", head):
        return PLY
    if b"ISO-10303-21;" in head[:1024]:
        return STEP
    if b"DBRep_DrawableShape" in head[:256] or b"CASCADE Topology V" in head[:256]:
        return BREP
    if re.match(rb"[^\r\n]{72}S *0*1\s*[\r\n]", head):
        return IGES
    return _detect_text(start, head)


def _detect_text(start: bytes, head: bytes) -> Format | None:
    if start.startswith(b"<") and b"<COLLADA" in head:
        return DAE
    if start.startswith(b"{") and b'"asset"' in head:
        return GLTF
    if re.match(rb"(ST)?C?N?4?n?OFF\b", start):
        return OFF
    if re.match(rb"solid\b", start, re.I) and re.search(rb"\b(facet|endsolid)\b", start, re.I):
        return STL
    text = decode_text(head)
    if re.search(r"^v[ \t]+\S+[ \t]+\S+[ \t]+\S", text, re.M) and "\0" not in text:
        return OBJ
    return None


def is_binary_stl(head: bytes, size: int) -> bool:
    """84 bytes and 50 for every triangle that it counts; many such begin with `solid` as well."""
    return len(head) >= 84 and size == 84 + 50 * int.from_bytes(head[80:84], "little")


def decode_text(data: bytes) -> str:
    """Text in UTF-8, or in UTF-16 with its mark; bytes that are neither become marks."""
    is_utf16 = data.startswith((b"\xff\xfe", b"\xfe\xff"))
    return data.decode("utf-16" if is_utf16 else "utf-8-sig", errors="replace")


def _detect_archived(path: Path) -> Format | None:
    try:
        with zipfile.ZipFile(path) as archive:
            names = [name.lower() for name in archive.namelist()]
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError):
        return None
    if any(name.endswith(".model") for name in names):
        return THREEMF
    if "manifest.xml" in names:
        return THREEDXML
    return ZAE if any(name.endswith(".dae") for name in names) else None
