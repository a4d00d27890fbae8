"""Anybody's cloud file as points."""

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.cloud import load_warnings
from industnerf.artifacts.part import Mesh, save_part
from industnerf.artifacts.ply import write_ply
from industnerf.errors import BadArtifact
from industnerf.external.points import import_points, read_points
from tests import solids
from tests.samples import unit_part

RNG = np.random.default_rng(0)
POINTS = RNG.normal(size=(50, 3))
MANY = 20_000  # drawn of a mesh


def read_file(path):
    return read_points(path, MANY, np.random.default_rng(0))[0]


def test_points_of_every_kind_of_file_are_those_that_were_written(tmp_path):
    write_ply(tmp_path / "a.ply", POINTS)
    np.savetxt(tmp_path / "a.xyz", POINTS)
    np.savez(tmp_path / "a.npz", points_mm=POINTS)
    np.savez(tmp_path / "b.npz", points=POINTS, view=np.zeros(3))
    for name in ("a.ply", "a.xyz", "a.npz", "b.npz"):
        np.testing.assert_allclose(read_file(tmp_path / name), POINTS, atol=1e-6)


@pytest.mark.parametrize("suffix", ["ply", "stl", "obj", "off"])
def test_of_a_mesh_points_are_drawn_evenly_by_area(tmp_path, suffix):
    trimesh.creation.box((2, 4, 8)).export(tmp_path / f"a.{suffix}")
    points = read_file(tmp_path / f"a.{suffix}")
    assert points.shape == (MANY, 3)
    on_top = np.isclose(np.abs(points[:, 2]), 4)  # two faces of 8, of 112 in all
    # 5 standard deviations of a share of 1/7 of so many
    assert on_top.mean() == pytest.approx(1 / 7, abs=5 * np.sqrt(6 / 49 / MANY))


def test_what_holds_no_points_is_refused_by_name(tmp_path):
    (tmp_path / "torn.ply").write_bytes(b"")
    write_ply(tmp_path / "none.ply", np.zeros((0, 3)))
    np.savez(tmp_path / "other.npz", xyz=POINTS)
    np.savez(tmp_path / "flat.npz", points_mm=POINTS[:, :2])
    for name, reason in (
        ("torn.ply", "cannot be read"),
        ("none.ply", "no point in the file"),
        ("other.npz", "none of points_mm, points, only xyz"),
        ("flat.npz", r"of shape \(50, 2\)"),
    ):
        with pytest.raises(BadArtifact, match=f"{name}.*{reason}"):
            read_file(tmp_path / name)


def test_points_that_are_not_finite_are_counted(tmp_path):
    np.savez(tmp_path / "a.npz", points_mm=np.vstack([POINTS, [[np.nan, 0, 0]]]))
    with pytest.raises(BadArtifact, match="1 of 51 points are not finite"):
        read_file(tmp_path / "a.npz")


def test_points_that_float32_cannot_hold_are_refused_by_name(tmp_path):
    np.savez(tmp_path / "a.npz", points_mm=np.vstack([POINTS, [[1e300, 0, 0]]]))
    with pytest.raises(BadArtifact, match=r"a\.npz: 1 of 51 points are too large: .* of 1e\+300"):
        read_file(tmp_path / "a.npz")


def test_what_is_remarked_on_is_the_file_s_points_not_the_rounded_ones(tmp_path):
    """At 1e7 float32 has steps of 1 mm: no side of 0.4 mm is left, and only the step is odd."""
    mesh = solids.box(0.2, 0.3, 0.4)
    mesh = Mesh.with_one_appearance(mesh.vertices + 1e7, mesh.faces)
    save_part(tmp_path / "block", unit_part("block"), mesh)
    np.savez(tmp_path / "far.npz", points_mm=mesh.vertices)
    (tmp_path / "out").mkdir()
    import_points(tmp_path / "far.npz", tmp_path / "block", MANY, 0, tmp_path / "out")
    (warnings,) = load_warnings(tmp_path / "out")
    assert "has steps of 1 mm, 2 of the diagonal" in warnings
