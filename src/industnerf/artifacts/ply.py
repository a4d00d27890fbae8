"""Binary PLY for people's own viewers; the suite itself reads the npz beside it."""

from pathlib import Path

import numpy as np
from jaxtyping import Float, Int16, Int32, UInt8


def write_ply(
    path: Path,
    points: Float[np.ndarray, "n 3"],
    *,
    colors: UInt8[np.ndarray, "n 3"] | None = None,
    confidence: Float[np.ndarray, "n"] | None = None,
    view: Int16[np.ndarray, "n"] | None = None,
    faces: Int32[np.ndarray, "m 3"] | None = None,
    face_colors: UInt8[np.ndarray, "m 3"] | None = None,
    unit: str = "mm",
) -> None:
    """Write points, or a mesh if `faces` is given.

    Colors are written as they are: linear ones of our own parts, sRGB of other photographs.
    Lengths are in `unit`, which the header says: the suite's own files are in mm.
    `confidence` has two columns, `confidence` and, for MeshLab, `quality`; `view` is the training
    view that weighs most in a point; `face_colors` need `faces`.
    """
    columns: list[tuple[str, str, np.ndarray]] = [
        (name, "f4", points[:, axis]) for axis, name in enumerate("xyz")
    ]
    if colors is not None:
        names = ("red", "green", "blue")
        columns += [(name, "u1", colors[:, axis]) for axis, name in enumerate(names)]
    if confidence is not None:
        # MeshLab shows `quality`; what it makes of a float named `confidence` is not its value
        columns += [(name, "f4", confidence) for name in ("confidence", "quality")]
    if view is not None:
        columns.append(("view", "i2", view))
    vertices = np.empty(len(points), [(name, "<" + kind) for name, kind, _ in columns])
    for name, _, values in columns:
        vertices[name] = values
    ply_types = {"f4": "float", "i2": "short", "u1": "uchar"}
    header = ["ply", "format binary_little_endian 1.0", f"comment lengths in {unit}"]
    header += [f"element vertex {len(vertices)}"]
    header += [f"property {ply_types[kind]} {name}" for name, kind, _ in columns]
    if faces is not None:
        header += [f"element face {len(faces)}", "property list uchar int vertex_indices"]
    if face_colors is not None:
        header += [f"property uchar {name}" for name in ("red", "green", "blue")]
    with path.open("wb") as file:
        file.write("\n".join([*header, "end_header\n"]).encode())
        file.write(vertices.tobytes())
        if faces is not None:
            row = [("count", "u1"), ("corners", "<i4", 3)]
            row += [] if face_colors is None else [("color", "u1", 3)]
            triangles = np.empty(len(faces), row)
            triangles["count"], triangles["corners"] = 3, faces
            if face_colors is not None:
                triangles["color"] = face_colors
            file.write(triangles.tobytes())
