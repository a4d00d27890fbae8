"""The real and the broken files beside the repository, where they exist."""

from pathlib import Path

import numpy as np
import pytest

from industnerf.errors import BadPart
from industnerf.geometry.raycast import RaycastingScene
from industnerf.parts.io.readers import read_solids
from industnerf.parts.repair import repair_mesh
from industnerf.parts.repair.mesh_ops import concatenate
from industnerf.parts.validation.checks import (
    MAX_BACK_FACE_SHARE,
    back_face_share,
    bad_edges,
    volume_mm3,
)
from tests.conftest import ROOT
from tests.parts.repair.shapes import settings

CAD = ROOT.parent / "shared" / "cad"
REAL = sorted(p for p in (CAD / "real").glob("*/*") if p.is_file()) if CAD.is_dir() else []
OCCT_SUFFIXES = (".step", ".stp", ".igs")
OTHERS = [path for path in REAL if path.suffix.lower() not in OCCT_SUFFIXES]

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not CAD.is_dir(), reason="../shared/cad is not there"),
]


def back_share(mesh):
    scene = RaycastingScene(mesh.vertices, mesh.faces)
    return back_face_share(mesh.vertices, mesh.faces, lambda o, d: scene.cast(o, d).face)


def read(path: Path):
    if path.suffix.lower() in OCCT_SUFFIXES:
        pytest.importorskip("OCP")
    return [solid.mesh for solid in read_solids(path, "mm").solids]


def read_nasty(name):
    return read(CAD / "nasty" / name)


@pytest.mark.parametrize("path", REAL, ids=lambda path: path.name)
def test_a_real_file_becomes_a_part_that_is_sound_from_outside(path):
    solids = read(path)
    cleaned = repair_mesh(solids, settings())
    assert cleaned.back_face_share < MAX_BACK_FACE_SHARE
    assert cleaned.back_face_share <= back_share(concatenate(solids)) + 1e-4  # a few of 1e5 rays
    assert len(cleaned.mesh.faces) >= 0.99 * sum(len(solid.faces) for solid in solids)


# What manifest.csv expects, of the files that are there for their geometry.
CLOSED = {
    "d_binary_header_solid.stl": 1,
    "d_duplicate_faces.stl": 1,
    "d_huge_scale.stl": 1,
    "mf_72214.stl": 1,
    "mf_472042.stl": 1,
    "trimesh_box.STL": 1,
    "d_hidden_internal.stl": 1,
    "trimesh_multibody.stl": 2,
    "trimesh_cube_compressed.obj": 1,
    "trimesh_negative_indices.obj": 1,
    "d_quads_missing_mtl.obj": 1,
    "assimp_box_UTF16BE.obj": 1,
    "Cube_10x10.igs": 1,
    "as1-oc-214.stp": 18,
    "red_cube_blue_cylinder.step": 2,
}


@pytest.mark.parametrize("name", CLOSED)
def test_a_broken_file_that_can_be_mended_comes_out_closed(name):
    solids = read_nasty(name)
    cleaned = repair_mesh(solids, settings())
    assert len(solids) == CLOSED[name]
    assert len(bad_edges(cleaned.mesh.faces)) == 0
    assert volume_mm3(cleaned.mesh.vertices, cleaned.mesh.faces) > 0
    assert cleaned.back_face_share == 0


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("d_duplicate_faces.stl", "repeated faces dropped: 400"),
        ("d_nan_vertices.stl", "faces dropped for a non-finite corner: 2 of 3476"),
        ("d_tjunctions.stl", "open edges: 4329"),
        ("d_hidden_internal.stl", "overlapping pairs of bodies: 1"),
        ("d_zero_thickness_sheet.stl", "flat: a sheet without thickness or volume"),
        ("trimesh_wallhole.obj", "open edges: 2"),
        ("trimesh_soup.stl", "open edges: 300"),
    ],
)
def test_what_is_wrong_is_said(name, message):
    cleaned = repair_mesh(read_nasty(name), settings())
    assert any(text.startswith(message) for text in cleaned.repairs + cleaned.residual_defects)


@pytest.mark.parametrize(
    "name",
    [
        "d_line_degenerate.stl",
        "d_single_face.stl",
        "assimp_triangle_with_empty_solid.stl",
        "single_triangle_no_normal.stl",
    ],
)
def test_what_is_no_surface_is_refused(name):
    """The last two hold one triangle as well: they can be read, but are no part."""
    with pytest.raises(BadPart, match="no part has fewer than 2"):
        repair_mesh(read_nasty(name), settings())


def test_the_sheet_looks_closed_though_it_is_not():
    """T-junctions leave open edges, but no ray slips through to a back face."""
    assert repair_mesh(read_nasty("d_tjunctions.stl"), settings()).back_face_share == 0


@pytest.mark.parametrize("path", OTHERS, ids=lambda path: path.name)
def test_cleaning_a_clean_part_finds_nothing(path):
    solids = read(path)
    once = repair_mesh(solids, settings())
    twice = repair_mesh(
        [once.mesh], settings(small_component_area=0.0)
    )  # one solid now: specks were protected
    assert twice.repairs == ()
    np.testing.assert_array_equal(twice.mesh.faces, once.mesh.faces)
