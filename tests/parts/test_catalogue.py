"""The parts as they are shipped.  No CAD kernel is needed, nor is one used."""

import dataclasses
import json
import shutil
import subprocess
import sys

import numpy as np
import pytest

from industnerf.errors import BadArtifact, BadPart
from industnerf.geometry.raycast import Scene
from industnerf.parts import checks
from industnerf.parts.catalogue import EMBEDDED, catalogue, digest, load

ENTRIES = catalogue()
every_part = pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry.id)


@pytest.fixture
def copied(tmp_path):
    """One entry, and a folder of its own that holds its file."""
    entry = ENTRIES[0]
    shutil.copy(EMBEDDED / f"{entry.id}.npz", tmp_path)
    return entry, tmp_path


def test_the_set_is_broad_enough():
    assert len(ENTRIES) >= 24
    assert len({entry.family for entry in ENTRIES}) >= 12


def test_ids_are_unique_and_name_the_files():
    ids = [entry.id for entry in ENTRIES]
    assert len(set(ids)) == len(ids)
    assert all(set(part_id) <= set("abcdefghijklmnopqrstuvwxyz0123456789-") for part_id in ids)
    assert {path.stem for path in EMBEDDED.glob("*.npz")} == set(ids)


def test_entries_are_ordered():
    assert list(ENTRIES) == sorted(ENTRIES, key=lambda entry: (entry.family, entry.id))


@every_part
def test_mesh_is_closed_oriented_and_as_catalogued(entry):
    vertices, faces = load(entry)
    checks.require_sound(entry.id, vertices, faces)
    assert len(faces) == entry.faces
    assert np.array_equal(np.unique(faces), np.arange(len(vertices)))
    assert checks.bodies(faces) == entry.bodies
    # The catalogue rounds to four decimals.
    assert checks.volume_mm3(vertices, faces) == pytest.approx(entry.volume_mm3, rel=0, abs=1e-4)
    assert checks.area_mm2(vertices, faces) == pytest.approx(entry.area_mm2, rel=0, abs=1e-4)
    assert checks.extents_mm(vertices) == pytest.approx(entry.extents_mm, rel=0, abs=1e-4)


@every_part
def test_volume_is_near_the_exact_one(entry):
    if entry.brep_volume_mm3 is None:
        assert entry.volume_deviation is None
        return
    # Chords cut off up to 5e-4 of the diagonal, from the outside and from the bores alike; what
    # that takes from a part of ordinary thickness was measured on a hundred parts: below 0.5 %.
    deviation = entry.volume_mm3 / entry.brep_volume_mm3 - 1
    assert deviation == pytest.approx(entry.volume_deviation, abs=1e-6)
    assert abs(deviation) < 0.005


@every_part
def test_hardly_a_ray_meets_a_face_from_behind(entry):
    vertices, faces = load(entry)
    scene = Scene(vertices, faces)
    share = checks.back_face_share(
        vertices, faces, lambda o, d: scene.cast(o, d).face, views=16, rays_across=48
    )
    assert share <= checks.MOST_BACK_FACES
    assert entry.back_face_share <= checks.MOST_BACK_FACES


def test_a_moved_vertex_is_noticed(copied):
    entry, folder = copied
    path = folder / f"{entry.id}.npz"
    with np.load(path) as arrays:
        vertices, faces = arrays["vertices"], arrays["faces"]
    vertices[0, 0] = np.nextafter(vertices[0, 0], np.float32(np.inf))
    np.savez_compressed(path, vertices=vertices, faces=faces)
    with pytest.raises(BadPart, match=f"'{entry.id}'.*another mesh than the catalogue.*edited"):
        load(entry, folder)


def test_a_torn_file_is_refused(copied):
    entry, folder = copied
    path = folder / f"{entry.id}.npz"
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(BadArtifact, match="cannot be read"):
        load(entry, folder)


def test_a_missing_file_says_how_to_get_it(tmp_path):
    with pytest.raises(BadArtifact, match=r"industnerf\.parts build"):
        load(ENTRIES[0], tmp_path)
    with pytest.raises(BadArtifact, match=r"industnerf\.parts build"):
        catalogue(tmp_path)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("{", "cannot be read"),
        ('{"schema": 0, "parts": []}', "schema 0"),
        ('{"schema": 1, "parts": [{"id": "x", "extents_mm": [1, 1, 1]}]}', "cannot be read"),
    ],
)
def test_a_bad_catalogue_is_refused(tmp_path, text, complaint):
    (tmp_path / "catalogue.json").write_text(text)
    with pytest.raises(BadArtifact, match=complaint):
        catalogue(tmp_path)


def test_digest_names_the_mesh_and_not_its_storage():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=np.float32)
    faces = np.array([[0, 1, 2]])
    assert digest(vertices, faces.astype(np.uint16)) == digest(vertices, faces.astype(np.int64))
    assert digest(vertices, faces) != digest(vertices, faces[:, ::-1])
    assert digest(vertices, faces) != digest(-vertices, faces)


def test_the_stored_catalogue_holds_only_what_entries_hold():
    stored = json.loads((EMBEDDED / "catalogue.json").read_text())
    names = {field.name for field in dataclasses.fields(ENTRIES[0])}
    assert all(set(row) == names for row in stored["parts"])


def test_reading_needs_no_cad_kernel():
    heavy = ("OCP", "build123d", "bd_warehouse", "py_gearworks", "manifold3d", "scipy", "torch")
    code = (
        "import sys, industnerf.parts.catalogue as c; c.load(c.catalogue()[0]);"
        f"print(*[name for name in {heavy} if name in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.split() == []
