"""Any clouds to a page, and a picture of each."""

import webbrowser
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image
from scipy.spatial import cKDTree

from industnerf.artifacts.files import atomic_write, write_text
from industnerf.errors import BadArtifact, BadParams
from industnerf.external.cloud_content import CloudContent
from industnerf.external.points import read_cloud
from industnerf.report.html.cloud_page import ColorScale, ShownCloud, render_cloud_page
from industnerf.seeds import generator
from industnerf.splats import core_box, preview

DRAWN = 65536  # points of a mesh
SCALE_SHARES = (0.002, 0.005, 0.01, 0.02, 0.05)  # ends of the scale of distances, in diagonals
START_SHARE = 0.01
NOTE = (
    "Clouds share one camera. Distance is to the nearest point of the {other} cloud; between "
    "points it is as large as their spacing."
)


def quick_look(
    files: Sequence[Path],
    out: Path | None = None,
    png: bool = False,
    min_opacity: float = 0.0,
    open_page: bool = False,
) -> None:
    """Write the page of `files` to `out` and print what it shows.

    Raises BadArtifact if a file cannot be read, BadParams if `out` is no page, or one of `files`.
    """
    page = Path(f"{files[0].name}.html") if out is None else out
    if page.suffix.lower() != ".html" or page.resolve() in {file.resolve() for file in files}:
        raise BadParams(f"--out {page}: must end in .html, and be none of the clouds")
    contents = [_read(file, min_opacity) for file in files]
    names = _names(files)
    title = "Quick look: " + ", ".join(names)
    clouds = [_shown(i, names, contents) for i in range(len(files))]
    low, high = core_box(np.concatenate([content.points for content in contents]))
    diagonal = float(np.linalg.norm(high - low)) or 1.0
    scale = ColorScale([share * diagonal for share in SCALE_SHARES], START_SHARE * diagonal)
    warnings = [
        f"{name}: {text}"
        for name, content in zip(names, contents, strict=True)
        for text in content.warnings
    ]
    note = NOTE.format(other="first" if len(files) > 2 else "other") if len(files) > 1 else ""
    text = render_cloud_page(
        "cloud_page.html.j2", title, clouds, "units", scale, note, warnings=warnings
    )
    write_text(page, text)
    for line in (*(f"{cloud.name}: {cloud.caption}" for cloud in clouds), *warnings):
        print(line)
    print(f"page: {page}")
    if png:
        picture = page.with_suffix(".png")
        with atomic_write(picture) as draft:
            rows = [preview(content.points, content.colors) for content in contents]
            Image.fromarray(np.vstack(rows)).save(draft, "PNG")
        print(f"picture: {picture}")
    if open_page and not webbrowser.open(page.resolve().as_uri()):
        print("no browser was found to open it in")


def _read(file: Path, min_opacity: float) -> CloudContent:
    if not file.is_file():
        raise BadArtifact(f"{file} is no file")
    return read_cloud(file, DRAWN, generator(0, "view", file.name), min_opacity)


def _names(files: Sequence[Path]) -> list[str]:
    """The names of the files, with their folders where two are called alike."""
    names = [file.name for file in files]
    has_twins = len(set(names)) < len(names)
    return [f"{i}: {file}" for i, file in enumerate(files, start=1)] if has_twins else names


def _shown(i: int, names: Sequence[str], contents: Sequence[CloudContent]) -> ShownCloud:
    content = contents[i]
    sides = " x ".join(f"{side:.4g}" for side in np.ptp(content.points, axis=0))
    kind = f"a mesh of {content.num_faces} faces" if content.num_faces else "a cloud"
    error = None
    if len(contents) > 1:
        other = contents[0] if i else contents[1]
        error = cKDTree(other.points).query(content.points)[0] if i or len(contents) == 2 else None
    return ShownCloud(
        names[i],
        content.points,
        f"{kind}, {sides}",
        content.colors,
        content.confidence,
        error,
    )
