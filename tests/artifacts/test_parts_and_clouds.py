"""Parts, clouds, truth and scores: what is written is what is read, or an error that names it."""

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.part import (
    UNSPECIFIED,
    Appearance,
    Mesh,
    load_mesh,
    load_part,
    load_parts,
    save_part,
    write_manifest,
)
from industnerf.artifacts.scores import Score, gather_scores, load_method_scores, save_scores
from industnerf.artifacts.truth import Floor, Truth
from industnerf.errors import BadArtifact, MetricError
from tests.samples import unit_part

BRASS = Appearance("brass", (0.7, 0.5, 0.2), 1.0, 0.3)
PART = unit_part(
    extents_mm=(3.0, 4.0, 0.0),
    volume_mm3=None,
    strata=("thin", "holes"),
    finishes=(UNSPECIFIED, BRASS),
    defects=("a", "b"),
)
MESH = Mesh(
    np.array([[0, 0, 0], [3, 0, 0], [0, 4, 0.1]]),
    np.array([[0, 1, 2]], np.int32),
    np.array([1], np.uint8),
)
CLOUD = Cloud(
    "p1",
    np.arange(6, dtype=np.float32).reshape(2, 3),
    np.array([[1, 2, 3], [4, 5, 6]], np.uint8),
    np.array([0.5, 1], np.float32),
    np.array([-1, 3], np.int16),
    7,
    8,
)


def test_a_part_survives_its_files(tmp_path):
    save_part(tmp_path, PART, MESH)
    mesh = load_mesh(tmp_path)
    assert load_part(tmp_path) == PART
    assert PART.diagonal_mm == 5.0
    np.testing.assert_array_equal(mesh.vertices, MESH.vertices)
    np.testing.assert_array_equal(mesh.faces, MESH.faces)
    np.testing.assert_array_equal(mesh.finish, MESH.finish)


def test_the_ply_beside_it_opens_in_other_tools(tmp_path):
    save_part(tmp_path, PART, MESH)
    other = trimesh.load_mesh(tmp_path / "mesh.ply", process=False)
    np.testing.assert_allclose(other.vertices, MESH.vertices, rtol=1e-7)
    np.testing.assert_array_equal(other.faces, MESH.faces)


def test_a_cloud_survives_its_files(tmp_path):
    CLOUD.save(tmp_path)
    read = Cloud.load(tmp_path)
    for name, value in vars(CLOUD).items():
        np.testing.assert_array_equal(getattr(read, name), value)
    assert Cloud.load_training_stats(tmp_path) == (7, 8)
    other = trimesh.load(tmp_path / "cloud.ply")
    np.testing.assert_array_equal(other.vertices, CLOUD.points_mm)
    np.testing.assert_array_equal(other.colors[:, :3], CLOUD.colors)
    columns = other.metadata["_ply_raw"]["vertex"]["data"]
    for name in ("confidence", "view"):
        np.testing.assert_array_equal(columns[name], getattr(CLOUD, name))


def test_a_cloud_of_another_schema_is_refused(tmp_path):
    np.savez_compressed(tmp_path / "cloud.npz", schema=2, **vars(CLOUD))
    with pytest.raises(BadArtifact, match=r"cloud\.npz has schema 2, this code reads 3"):
        Cloud.load(tmp_path)


def test_equal_content_is_equal_bytes(tmp_path):
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        CLOUD.save(tmp_path / name)
        save_part(tmp_path / name, PART, MESH)
    for file in (tmp_path / "a").iterdir():
        assert file.read_bytes() == (tmp_path / "b" / file.name).read_bytes()


def test_truth_survives_its_files(tmp_path):
    floors = {"emd P1-even": Floor(0.1, 0.001)}
    truth = Truth(np.zeros((2, 3), np.float32), np.array([True, False]), floors)
    truth.save(tmp_path)
    read = Truth.load(tmp_path)
    assert read.floors == truth.floors
    np.testing.assert_array_equal(read.visible, truth.visible)


@pytest.mark.parametrize(
    ("load", "file"),
    [
        (load_part, "part.json"),
        (load_mesh, "mesh.npz"),
        (Cloud.load, "cloud.npz"),
        (Truth.load, "floors.json"),
    ],
)
@pytest.mark.parametrize("content", [b"torn", b"PK\x03\x04 torn in a zip", b""])
def test_a_missing_or_torn_file_is_named_with_the_stage_that_mends_it(
    tmp_path, load, file, content
):
    with pytest.raises(BadArtifact, match=rf"{file}.*dvc repro"):
        load(tmp_path)
    (tmp_path / file).write_bytes(content)
    with pytest.raises(BadArtifact, match=rf"{file}.*dvc repro"):
        load(tmp_path)


def test_another_schema_is_refused(tmp_path):
    save_part(tmp_path, PART, MESH)
    path = tmp_path / "part.json"
    path.write_text(path.read_text().replace('"schema": 2', '"schema": 99'))
    with pytest.raises(BadArtifact, match="schema 99, this code reads 2"):
        load_part(tmp_path)


def test_the_manifest_has_a_row_a_part(tmp_path):
    save_part_in = tmp_path / "p1"
    save_part_in.mkdir()
    save_part(save_part_in, PART, MESH)
    write_manifest(tmp_path)
    head, row = (tmp_path / "manifest.csv").read_text().splitlines()
    assert head.startswith("part_id,family,designation")
    assert row.endswith("3.0,4.0,0.0,thin; holes,unstated; brass,a; b")
    assert load_parts(tmp_path) == [PART]


def test_scores_survive_their_files_and_never_hold_nan(tmp_path):
    score = Score("emd", "P1-even", 0.1, 0.05, "diagonal", "ok", floor_se=0.001)
    (tmp_path / "p1").mkdir()
    save_scores(tmp_path / "p1", [score])
    (row,) = load_method_scores(tmp_path, "hull")
    assert (row.part_id, row.method, row.score) == ("p1", "hull", score)
    gather_scores(tmp_path, "hull")
    assert (tmp_path / "scores.csv").read_text().splitlines()[1] == (
        "p1,hull,emd,P1-even,0.1,0.05,diagonal,ok,0.001"
    )
    with pytest.raises(MetricError, match="nan"):
        Score("emd", "P1-even", float("nan"), 0.05, "diagonal", "ok")
