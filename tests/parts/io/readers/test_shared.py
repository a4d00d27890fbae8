"""The real and the broken files of ../shared/cad, where they lie beside the repository."""

import csv
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from industnerf.artifacts.solids import Solids
from industnerf.parts.io.readers import write_solids
from industnerf.parts.io.readers.formats import SUFFIXES
from industnerf.runner import ProcessRunner

SHARED = Path(__file__).parents[5] / "shared" / "cad"
OCCT_SUFFIXES = (".step", ".stp", ".igs")
# What must end as one sentence, and a word of it; every other nasty file loads.
REFUSED = {
    "assimp_BoxWithInfinites.glb": "finite",
    "assimp_empty.obj": "empty",
    "assimp_invalid.off": "corners",
    "d_huge_offset_f32.stl": "32-bit",
    "d_text.stl": "no STL",
    "d_truncated_binary.stl": "cut short",
    "trimesh_empty.stl": "no face",
    "trimesh_ply_empty_ascii.ply": "no face",
}
SOLIDS = {"as1-oc-214.stp": 18, "red_cube_blue_cylinder.step": 2, "trimesh_multibody.stl": 2}
COLORS = {
    "as1-oc-214.stp": {"#ff0000", "#00ff00", "#0000ff", "#ccff00", "#ff8000"},
    "red_cube_blue_cylinder.step": {"#dd5228", "#3b61b4"},
}

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not SHARED.is_dir(), reason="needs ../shared/cad"),
]


def outcomes(paths, folder):
    """Of each path the solids, or why there are none."""
    for i in range(len(paths)):
        (folder / str(i)).mkdir()
    works = [partial(write_solids, path, "mm", folder / str(i)) for i, path in enumerate(paths)]
    errors = {o.index: o.error for o in ProcessRunner(2).map(works, 120.0, 6144)}
    return {
        path: Solids.load(folder / str(i)) if errors[i] is None else errors[i]
        for i, path in enumerate(paths)
    }


def files(name):
    """The CAD files there; of the kernel's formats only if the kernel is."""
    with (SHARED / name / "manifest.csv").open() as table:
        paths = [SHARED / row["file"] for row in csv.DictReader(table)]
    return [
        path
        for path in paths
        if path.suffix.lower() in SUFFIXES
        and (find_spec("OCP") is not None or path.suffix.lower() not in OCCT_SUFFIXES)
    ]


def test_every_nasty_file_gives_what_its_manifest_expects(tmp_path):
    for path, result in outcomes(files("nasty"), tmp_path).items():
        if path.name in REFUSED:
            assert isinstance(result, str), path.name
            assert result.startswith(f"{path.name}: "), result
            assert REFUSED[path.name] in result, result
        else:
            assert isinstance(result, Solids), f"{path.name}: {result}"
            assert len(result.solids) >= SOLIDS.get(path.name, 1), path.name
            assert COLORS.get(path.name, set()) <= {f.name for f in result.finishes}, path.name


def test_every_real_file_loads_and_has_the_size_of_its_manifest(tmp_path):
    with (SHARED / "real" / "manifest.csv").open() as table:
        boxes = {SHARED / row["file"]: row["bbox"] for row in csv.DictReader(table)}
    for path, result in outcomes(files("real"), tmp_path).items():
        assert isinstance(result, Solids), f"{path.name}: {result}"
        points = np.concatenate([s.mesh.triangles.reshape(-1, 3) for s in result.solids])
        expected = [float(side) for side in boxes[path].split("x")]
        if result.unit == "m, stated":  # the manifest has the file's own numbers there
            expected = [1000 * side for side in expected]
        # the manifest rounds to four digits, and its tessellation was another
        assert sorted(np.ptp(points, axis=0)) == pytest.approx(sorted(expected), rel=5e-3), path
