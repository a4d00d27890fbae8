"""Formats of clouds that are not read, and the command that turns each into one that is."""

from pathlib import Path

PDAL = "`pdal translate {name} {stem}.ply`"
CLOUDCOMPARE = "`CloudCompare -SILENT -O {name} -C_EXPORT_FMT PLY -SAVE_CLOUDS`"
RECAP = "export it from Autodesk ReCap as E57 or PTS, and E57 by CloudCompare as PLY"
SPLATS = "save it as PLY in the viewer that it is of, such as SuperSplat"
BLENDER = "open it in Blender and export it as GLB"
CONVERTERS = {
    ".las": ("LAS", PDAL),
    ".laz": ("LAZ", PDAL),
    ".e57": ("E57", CLOUDCOMPARE),
    ".ptx": ("PTX", CLOUDCOMPARE),
    ".bin": ("CloudCompare's own format", CLOUDCOMPARE),
    ".fls": ("FARO's format", CLOUDCOMPARE),
    ".rcp": ("ReCap's format", RECAP),
    ".rcs": ("ReCap's format", RECAP),
    ".splat": ("a format of Gaussian splats", SPLATS),
    ".ksplat": ("a format of Gaussian splats", SPLATS),
    ".spz": ("a format of Gaussian splats", SPLATS),
    ".sog": ("a format of Gaussian splats", SPLATS),
    ".fbx": ("FBX", BLENDER),
    ".blend": ("Blender's format", BLENDER),
    ".usd": ("USD", BLENDER),
    ".usdz": ("USD", BLENDER),
    ".vtk": ("VTK", "`meshio convert {name} {stem}.ply`"),
    ".vtp": ("VTK", "`meshio convert {name} {stem}.ply`"),
}
MAGIC = {b"LASF": ".las", b"ASTM-E57": ".e57"}  # whatever such a file is called


def converter_hint(file: Path) -> str:
    """What the file is, and how to convert it; empty for one that may be read."""
    suffix = file.suffix.lower()
    if file.is_file():
        with file.open("rb") as stream:
            start = stream.read(8)
        suffix = next((each for magic, each in MAGIC.items() if start.startswith(magic)), suffix)
    if suffix not in CONVERTERS:
        return ""
    name, command = CONVERTERS[suffix]
    return f"it is {name}, which is not read: {command.format(name=file.name, stem=file.stem)}"
