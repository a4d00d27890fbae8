"""Cameras from photographs alone: COLMAP's structure from motion, by pycolmap."""

import shutil
from importlib import import_module
from pathlib import Path
from typing import Any

from industnerf.errors import BadArtifact, ReconstructionFailed
from industnerf.reconstruct.camera_files.colmap import images_file
from industnerf.reconstruct.image_paths import SUFFIXES

MIN_SHARE = 0.5  # of the photographs whose camera is found; fewer is worth more than a word
INSTALL = "pip install -e '.[sfm]'"


def find_cameras(images_dir: Path, folder: Path) -> tuple[Path, str]:
    """The model of the cameras that took the photographs in `images_dir`, made in `folder`.

    And a sentence on it.  A model of the same photographs that is in `folder` already is taken.

    Features are SIFT, all pairs are matched, and all photographs share one lens of COLMAP's model
    OPENCV: Schoenberger and Frahm, "Structure-from-Motion Revisited" (2016).  Raises BadArtifact if
    pycolmap is missing or there are no photographs, ReconstructionFailed if too few of them join.
    """
    model, listing = folder / "model", folder / "photographs.txt"
    names = _photographs(images_dir)
    content = "".join(f"{name} {(images_dir / name).stat().st_size}\n" for name in names)
    if images_file(model) and listing.read_text(encoding="utf-8") == content:
        return model, f"cameras of an earlier run are taken from {model}"
    pycolmap = _load_pycolmap()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    best = _run(pycolmap, images_dir, folder, names)
    num_found = 0 if best is None else best.num_reg_images()
    if num_found < max(2, MIN_SHARE * len(names)):
        raise ReconstructionFailed(
            f"--sfm: the cameras of {num_found} of {len(names)} photographs were found, it takes "
            f"{MIN_SHARE:.0%}: neighboring photographs must overlap by two thirds, and part or "
            "ground need texture (put it on a newspaper and take the ground into the picture)"
        )
    draft = folder / "draft"
    draft.mkdir()
    best.write(draft)
    listing.write_text(content, encoding="utf-8")
    draft.rename(model)
    error = best.compute_mean_reprojection_error()
    return model, (
        f"the cameras of {num_found} of {len(names)} photographs were found, to {error:.2f} px, in "
        f"a unit of their own; they are kept in {model}"
    )


def _photographs(images_dir: Path) -> list[str]:
    if not images_dir.is_dir():
        raise BadArtifact(f"--images {images_dir}: is no folder")
    names = sorted(path.name for path in images_dir.iterdir() if path.suffix.lower() in SUFFIXES)
    if len(names) < 2:
        raise BadArtifact(f"--images {images_dir}: {len(names)} photographs, it takes at least 2")
    return names


def _load_pycolmap() -> Any:
    try:
        return import_module("pycolmap")
    except ImportError:
        raise BadArtifact(
            f"--sfm needs pycolmap, which is not installed: {INSTALL}; or find the cameras by "
            "COLMAP itself and give its model as --cameras sparse/0"
        ) from None


def _run(pycolmap: Any, images_dir: Path, folder: Path, names: list[str]) -> Any:
    """The model that joins most photographs, or None."""
    pycolmap.set_random_seed(0)
    pycolmap.logging.minloglevel = 1  # warnings: it logs a page a photograph
    database = folder / "database.db"
    pycolmap.extract_features(
        database,
        images_dir,
        image_names=names,
        camera_mode=pycolmap.CameraMode.SINGLE,
        reader_options=pycolmap.ImageReaderOptions(camera_model="OPENCV"),
    )
    pycolmap.match_exhaustive(database)
    models = pycolmap.incremental_mapping(database, images_dir, folder)
    return max(models.values(), key=lambda model: model.num_reg_images(), default=None)
