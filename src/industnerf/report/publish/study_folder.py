"""A finished report as files small enough to be committed, so that a clone shows its numbers."""

import io
import shutil
from pathlib import Path
from typing import Any

from PIL import Image

from industnerf.artifacts.files import write_json, write_text
from industnerf.errors import BadArtifact
from industnerf.report.publish.provenance import environment
from industnerf.report.tables.formats import markdown_table

COPIED_FILES = {
    "table1.csv": "every method: EMD, floor, failures, size, what it learned from",
    "table1.md": "the same, with seconds",
    "table2.csv": "the paper's three losses, on all test parts and on one of each family",
    "table2.md": "the same, with all that belongs beside them",
    "inspection.csv": "every method in millimeters: EMD, Hausdorff-95, what is in tolerance",
    "inspection.md": "the same",
    "goals.csv": "what was to be reached, and what was",
    "goals.md": "the same",
    "comparisons.csv": "paired tests between methods",
    "comparisons.md": "the same",
    "strata.csv": "each method on thin parts, on parts with pockets, and so on",
    "strata.md": "the same, a line a method",
    "scores.csv": "every score of every part: what all tables are made of",
    "cost.csv": "seconds and peak memory of every result",
    "cost.md": "their means, and those of learning, a line a method",
}
# By other names than DVC's: below one of its own it would take the folder for a second pipeline.
RUN_FILES = {  # what is called so, and what it is
    "params.yaml": ("params.yaml", "the values it was run with"),
    "pipeline.yaml": ("dvc.yaml", "the dvc.yaml that was run"),
    "pipeline.lock": ("dvc.lock", "the dvc.lock of the run"),
}
GENERATED_FILES = {
    "environment.json": "the machine and the versions",
    "made.json": "command, day, commit, and what differed from it",
}
IMAGE_BYTES = 1_400_000  # of all together
IMAGE_WIDTHS = (2200, 1800, 1500, 1200, 1000, 800)  # px that are tried, widest first
IMAGE_COLORS = 256


def publish_study(report: Path, out: Path, provenance: dict[str, Any], project: Path) -> None:
    """Fill `out` anew from the folder `report`; `made` says where that comes from.

    `project` has what was run beside it: settings go on to change, a published result does not.

    Raises BadArtifact that names the first file that is missing, and leaves `out` as it is.
    """
    needed = [
        *(report / name for name in COPIED_FILES),
        *(project / name for name, _ in RUN_FILES.values()),
    ]
    for path in needed:
        if not path.exists():
            raise BadArtifact(f"{path} is missing; `dvc repro -f -s report` in {project} writes it")
    draft = out.with_name(f".{out.name}.draft")
    shutil.rmtree(draft, ignore_errors=True)
    draft.mkdir(parents=True)
    _write_files(draft, report, provenance, project)
    shutil.rmtree(out, ignore_errors=True)
    draft.rename(out)


def _write_files(out: Path, report: Path, provenance: dict[str, Any], project: Path) -> None:
    for name in COPIED_FILES:
        shutil.copyfile(report / name, out / name)
    for name, (source, _) in RUN_FILES.items():
        shutil.copyfile(project / source, out / name)
    images = sorted(report.glob("*.png"))
    for path in images:
        (out / path.name).write_bytes(downsample_png(path.read_bytes(), IMAGE_BYTES // len(images)))
    write_json(out / "environment.json", environment())
    write_json(out / "made.json", provenance)
    write_text(out / "README.md", readme_text(out, provenance))


def readme_text(out: Path, provenance: dict[str, Any]) -> str:
    """The README.md of the published folder `out`."""
    images = sorted(path.name for path in out.glob("*.png"))
    run_files = {name: text for name, (_, text) in RUN_FILES.items()}
    files = [
        [f"`{name}`", text] for name, text in (COPIED_FILES | run_files | GENERATED_FILES).items()
    ]
    return (
        f"# Results of `{provenance['command']}`\n\n"
        "Copied from its report by `pipeline/publish.py`; not to be edited.  "
        f"docs/reference/protocol.md says what the numbers are.{_rebuilt_sentence(provenance)}\n\n"
        f"{markdown_table(['file', 'what'], files)}\n"
        + "".join(f"![{name}]({name})\n" for name in images)
    )


def _rebuilt_sentence(provenance: dict[str, Any]) -> str:
    if (rebuilt := provenance.get("rebuilt")) is None:
        return ""
    return (
        f"  Its tables were made anew from its scores and costs on {rebuilt['date']}, commit "
        f"{rebuilt['commit']}, by `pipeline/rebuild_tables.py`: no score was measured anew."
    )


def downsample_png(png: bytes, budget: int) -> bytes:
    """`png` with a palette and as wide as `budget` bytes allow; never wider than it is.

    If even the narrowest is larger than that, it is returned all the same.
    """
    reduced = png
    for width in IMAGE_WIDTHS:
        reduced = _resize_with_palette(png, width)
        if len(reduced) <= budget:
            break
    return reduced


def _resize_with_palette(png: bytes, width: int) -> bytes:
    with Image.open(io.BytesIO(png)) as image:
        rgb = image.convert("RGB")
    rgb.thumbnail((width, rgb.height), Image.Resampling.LANCZOS)
    out = io.BytesIO()
    # Of Pillow's choices of a palette the nearest to the picture, and among the smallest files;
    # without dithering, which no PNG can compress.
    paletted = rgb.quantize(
        IMAGE_COLORS, Image.Quantize.MAXCOVERAGE, kmeans=3, dither=Image.Dither.NONE
    )
    paletted.save(out, "PNG", optimize=True)
    return out.getvalue()
