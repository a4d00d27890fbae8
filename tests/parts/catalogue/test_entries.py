"""The parts as they are shipped.  No CAD kernel is needed, nor is one used."""

import dataclasses
import json
import shutil
import subprocess
import sys

import numpy as np
import pytest

from industnerf.errors import BadArtifact, BadPart
from industnerf.geometry.raycast import RaycastingScene
from industnerf.parts.catalogue.entries import (
    EMBEDDED_FOLDER,
    CatalogueEntry,
    load_catalogue_mesh,
    mesh_digest,
    read_catalogue,
)
from industnerf.parts.measure import MeshProperties, measure
from industnerf.parts.validation import checks

ENTRIES = read_catalogue()
every_part = pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry.id)


@pytest.fixture
def copied(tmp_path):
    """One entry, and a folder of its own that holds its file."""
    entry = ENTRIES[0]
    shutil.copy(EMBEDDED_FOLDER / f"{entry.id}.npz", tmp_path)
    return entry, tmp_path


def test_the_set_is_broad_enough():
    assert len(ENTRIES) >= 100
    assert len({entry.family for entry in ENTRIES}) >= 16
    assert {entry.origin for entry in ENTRIES} == {"embedded"}


def test_the_set_is_small_enough_to_ship():
    assert sum(path.stat().st_size for path in EMBEDDED_FOLDER.glob("*.npz")) < 10e6


def test_ids_are_unique_and_name_the_files():
    ids = [entry.id for entry in ENTRIES]
    assert len(set(ids)) == len(ids)
    assert all(set(part_id) <= set("abcdefghijklmnopqrstuvwxyz0123456789-") for part_id in ids)
    assert {path.stem for path in EMBEDDED_FOLDER.glob("*.npz")} == set(ids)


def test_entries_are_ordered():
    assert list(ENTRIES) == sorted(ENTRIES, key=lambda entry: (entry.family, entry.id))


@every_part
def test_mesh_is_closed_oriented_and_as_catalogued(entry):
    mesh, known = load_catalogue_mesh(entry), entry.measured
    checks.require_watertight(entry.id, mesh.vertices, mesh.faces)
    assert len(mesh.faces) == known.faces
    assert np.array_equal(np.unique(mesh.faces), np.arange(len(mesh.vertices)))
    assert np.array_equal(np.unique(mesh.finish), np.arange(len(entry.finishes)))
    assert checks.count_bodies(mesh.faces) == known.bodies
    assert checks.euler_number(mesh.faces) == known.euler_number
    # The catalogue keeps ten digits; the order of a sum can cost one more.
    volume, area = (f(mesh.vertices, mesh.faces) for f in (checks.volume_mm3, checks.area_mm2))
    assert volume == pytest.approx(known.volume_mm3, rel=1e-9)
    assert area == pytest.approx(known.area_mm2, rel=1e-9)
    assert checks.extents_mm(mesh.vertices) == pytest.approx(known.extents_mm, rel=1e-9)


@every_part
def test_volume_is_near_the_exact_one(entry):
    # Chords cut off up to 5e-4 of the diagonal, from the outside and from the bores alike; what
    # that takes from a part of ordinary thickness was measured on a hundred parts: below 0.5 %.
    # A spring is all thin wire.
    assert abs(entry.volume_deviation) < (0.02 if "spring" in entry.id else 0.005)


@every_part
def test_hardly_a_ray_meets_a_face_from_behind(entry):
    mesh = load_catalogue_mesh(entry)
    scene = RaycastingScene(mesh.vertices, mesh.faces)
    share = checks.back_face_share(
        mesh.vertices, mesh.faces, lambda o, d: scene.cast(o, d).face, views=16, rays_per_side=48
    )
    assert share <= checks.MAX_BACK_FACE_SHARE
    assert entry.back_face_share <= checks.MAX_BACK_FACE_SHARE


@pytest.mark.slow
@pytest.mark.parametrize("entry", ENTRIES[::5], ids=lambda entry: entry.id)
def test_facts_are_those_of_the_mesh(entry):
    known, measured = entry.measured, measure(load_catalogue_mesh(entry))
    # Another processor's ray caster may round another way at an edge: some of 4096 samples.
    assert measured.visible_share == pytest.approx(known.visible_share, abs=2e-3)
    assert measured.hull_hidden_share == pytest.approx(known.hull_hidden_share, abs=2e-3)
    assert measured.strata == known.strata


def test_a_moved_vertex_is_noticed(copied):
    entry, folder = copied
    path = folder / f"{entry.id}.npz"
    with np.load(path) as arrays:
        stored = dict(arrays)
    stored["vertices"][0, 0] = np.nextafter(stored["vertices"][0, 0], np.float32(np.inf))
    np.savez_compressed(path, **stored)
    with pytest.raises(BadPart, match=f"'{entry.id}'.*another mesh than the catalogue.*edited"):
        load_catalogue_mesh(entry, folder)


def test_a_torn_file_is_refused(copied):
    entry, folder = copied
    path = folder / f"{entry.id}.npz"
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(BadArtifact, match="cannot be read"):
        load_catalogue_mesh(entry, folder)


def test_a_missing_file_says_how_to_get_it(tmp_path):
    with pytest.raises(BadArtifact, match=r"industnerf\.parts build"):
        load_catalogue_mesh(ENTRIES[0], tmp_path)
    with pytest.raises(BadArtifact, match=r"industnerf\.parts build"):
        read_catalogue(tmp_path)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("{", "cannot be read"),
        ('{"schema": 0, "parts": []}', "schema 0"),
        ('{"schema": 1, "parts": []}', "schema 1, this code reads 2"),
        ('{"schema": 2, "parts": [{"id": "x", "measured": {}}]}', "cannot be read"),
    ],
)
def test_a_bad_catalogue_is_refused(tmp_path, text, complaint):
    (tmp_path / "catalogue.json").write_text(text)
    with pytest.raises(BadArtifact, match=complaint):
        read_catalogue(tmp_path)


def test_digest_names_the_mesh_and_not_its_storage():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=np.float32)
    faces, finish = np.array([[0, 1, 2]]), np.array([0], np.uint8)
    here = mesh_digest(vertices, faces.astype(np.uint16), finish)
    assert here == mesh_digest(vertices, faces.astype(np.int64), finish)
    assert here != mesh_digest(vertices, faces[:, ::-1], finish)
    assert here != mesh_digest(-vertices, faces, finish)
    assert here != mesh_digest(vertices, faces, finish + np.uint8(1))


def test_the_stored_catalogue_holds_only_what_entries_hold():
    stored = json.loads((EMBEDDED_FOLDER / "catalogue.json").read_text())
    names = {field.name for field in dataclasses.fields(CatalogueEntry)}
    measured = {field.name for field in dataclasses.fields(MeshProperties)}
    assert all(set(row) == names for row in stored["parts"])
    assert all(set(row["measured"]) == measured for row in stored["parts"])


def test_reading_needs_no_cad_kernel():
    heavy = ("OCP", "build123d", "bd_warehouse", "py_gearworks", "manifold3d", "scipy", "torch")
    code = (
        "import sys, industnerf.parts.catalogue.entries as c;"
        "c.load_catalogue_mesh(c.read_catalogue()[0]);"
        f"print(*[name for name in {heavy} if name in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.split() == []
