"""What one file held, written and read back."""

import json

import numpy as np
import pytest

from industnerf.artifacts.part import UNSPECIFIED, Appearance, Mesh
from industnerf.artifacts.solids import Solid, Solids, solid_names
from industnerf.errors import BadArtifact

RED = Appearance("#ff0000", (1.0, 0.0, 0.0), 0.0, 0.5)


def mesh_of(vertices, faces, face_appearance):
    return Mesh(
        np.array(vertices, float), np.array(faces, np.int32), np.array(face_appearance, np.uint8)
    )


@pytest.fixture
def solids():
    points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (np.nan, 0, np.inf)]
    return Solids(
        "a file.stp",
        "STEP",
        "mm, stated",
        (UNSPECIFIED, RED),
        ("a remark", "øther"),
        (
            Solid("one", mesh_of(points, [(0, 1, 2), (1, 2, 3)], [0, 1])),
            Solid("one", mesh_of(points[:3], [(2, 1, 0)], [1])),
        ),
    )


def test_what_is_saved_is_read(solids, tmp_path):
    solids.save(tmp_path)
    loaded = Solids.load(tmp_path)
    for name in ("file", "format", "unit", "finishes", "warnings"):
        assert getattr(loaded, name) == getattr(solids, name)
    for saved_solid, loaded_solid in zip(loaded.solids, solids.solids, strict=True):
        assert saved_solid.name == loaded_solid.name
        for name, array in vars(loaded_solid.mesh).items():
            np.testing.assert_array_equal(getattr(saved_solid.mesh, name), array)
            assert getattr(saved_solid.mesh, name).dtype == array.dtype
    assert solid_names(tmp_path) == ("one", "one")


def test_equal_content_is_equal_bytes(solids, tmp_path):
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        solids.save(tmp_path / name)
    for name in ("solids.json", "solids.npz"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def rewrite_arrays(folder, **arrays):
    with np.load(folder / "solids.npz") as stored:
        arrays_kept = dict(stored)
    np.savez(folder / "solids.npz", **(arrays_kept | arrays))


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"faces_0": np.array([(0, 1, 9), (0, 1, 2)], np.int32)}, "one that names no vertex"),
        ({"faces_0": np.array([(0, 1, -1), (0, 1, 2)], np.int32)}, "one that names no vertex"),
        ({"faces_0": np.zeros((0, 3), np.int32), "finish_0": np.zeros(0, np.uint8)}, "no face"),
        ({"finish_0": np.array([0, 2], np.uint8)}, "a face without a finish"),
        ({"finish_0": np.array([0], np.uint8)}, r"has shapes \(4, 3\), \(2, 3\) and \(1,\)"),
    ],
)
def test_a_mesh_that_does_not_hang_together_is_refused(solids, tmp_path, arrays, message):
    solids.save(tmp_path)
    rewrite_arrays(tmp_path, **arrays)
    with pytest.raises(BadArtifact, match=message):
        Solids.load(tmp_path)


def test_what_is_missing_torn_or_of_another_schema_is_named(solids, tmp_path):
    with pytest.raises(BadArtifact, match=r"solids\.json is missing\. `dvc repro solids`"):
        Solids.load(tmp_path)
    solids.save(tmp_path)
    data = (tmp_path / "solids.npz").read_bytes()
    (tmp_path / "solids.npz").write_bytes(data[: len(data) // 2])
    with pytest.raises(BadArtifact, match=r"solids\.npz cannot be read"):
        Solids.load(tmp_path)
    metadata = json.loads((tmp_path / "solids.json").read_text())
    (tmp_path / "solids.json").write_text(json.dumps(metadata | {"schema": 0}))
    with pytest.raises(BadArtifact, match="has schema 0, this code reads 2"):
        solid_names(tmp_path)
