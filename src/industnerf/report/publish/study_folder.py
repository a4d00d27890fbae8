"""Publish a report: copy its files, with smaller images, into a folder that is committed."""

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
    "table1.csv": "every method: EMD, floor, failures, size, training parts",
    "table1.md": "the same, with seconds",
    "table2.csv": "the paper's three losses, on all test parts and on one of each family",
    "table2.md": "the same, with PSNR, SSIM, coverage and confidence",
    "inspection.csv": "every method in millimeters: EMD, Hausdorff-95, shares within tolerance",
    "inspection.md": "the same",
    "goals.csv": "goals, and the values measured",
    "goals.md": "the same",
    "comparisons.csv": "paired tests between methods",
    "comparisons.md": "the same",
    "strata.csv": "each method by stratum: thin parts, parts with pockets, and so on",
    "strata.md": "the same, a row per method",
    "scores.csv": "every score of every part; all tables are made of it",
    "cost.csv": "seconds and peak memory of every result",
    "cost.md": "their means, and those of training, a row per method",
    "origins.md": "which results were made on which machine, with which libraries",
}
COPIED_FOLDERS = {
    "metrics": "what `dvc metrics show` prints, a file per method",
    "plots": "what `dvc plots show` draws",
}
# Not by DVC's names: it would take the folder for a second pipeline.
RUN_FILES = {  # published name: source, description
    "params.yaml": ("params.yaml", "the parameters of the run"),
    "pipeline.yaml": ("dvc.yaml", "the dvc.yaml of the run"),
    "pipeline.lock": ("dvc.lock", "the dvc.lock of the run"),
}
GENERATED_FILES = {
    "environment.json": "the machine and the versions",
    "made.json": "command, day, commit, and the files that differed from it",
}
IMAGE_BYTES = 1_400_000  # of all together
IMAGE_WIDTHS = (2200, 1800, 1500, 1200, 1000, 800)  # px, tried widest first
IMAGE_COLORS = 256


def publish_study(report: Path, out: Path, provenance: dict[str, Any], project: Path) -> None:
    """Replace `out` by the files of the folder `report`; `provenance` goes into made.json.

    params.yaml, dvc.yaml and dvc.lock are copied from `project`. Raises BadArtifact that names the
    first file that is missing, and leaves `out` as it is.
    """
    needed = [
        *(report / name for name in (*COPIED_FILES, *COPIED_FOLDERS)),
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
    for name in COPIED_FOLDERS:
        shutil.copytree(report / name, out / name)
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
        [f"`{name}`", text]
        for name, text in (COPIED_FILES | COPIED_FOLDERS | run_files | GENERATED_FILES).items()
        if (out / name).exists() or name in GENERATED_FILES  # older results lack some
    ]
    return (
        f"# Results of `{provenance['command']}`\n\n"
        "Copied from its report by `pipeline/publish.py`; not to be edited. "
        f"docs/reference/protocol.md defines the numbers.{_rebuilt_sentence(provenance)}\n\n"
        f"{markdown_table(['file', 'what'], files)}\n"
        + "".join(f"![{name}]({name})\n" for name in images)
    )


def _rebuilt_sentence(provenance: dict[str, Any]) -> str:
    if (rebuilt := provenance.get("rebuilt")) is None:
        return ""
    return (
        f" Its tables were rebuilt from its scores and costs on {rebuilt['date']}, commit "
        f"{rebuilt['commit']}, by `pipeline/rebuild_tables.py`; no score was measured again."
    )


def downsample_png(png: bytes, budget: int) -> bytes:
    """`png` with a palette, as wide as `budget` bytes allow and never wider than it was.

    The narrowest is returned even if it is larger than that.
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
    # Of Pillow's choices of a palette the nearest to the image, and among the smallest files;
    # without dithering, which no PNG can compress.
    paletted = rgb.quantize(
        IMAGE_COLORS, Image.Quantize.MAXCOVERAGE, kmeans=3, dither=Image.Dither.NONE
    )
    paletted.save(out, "PNG", optimize=True)
    return out.getvalue()
