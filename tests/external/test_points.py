"""Anybody's cloud file as points."""

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.cloud import load_warnings
from industnerf.artifacts.part import Mesh, save_part
from industnerf.artifacts.ply import write_ply
from industnerf.errors import BadArtifact
from industnerf.external.points import choose_axes, import_points, read_cloud
from tests import solids
from tests.samples import unit_part

RNG = np.random.default_rng(0)
POINTS = RNG.normal(size=(50, 3))
MANY = 20_000  # drawn of a mesh


def read_file(path):
    return read_cloud(path, MANY, np.random.default_rng(0)).points


def test_points_of_every_kind_of_file_are_those_that_were_written(tmp_path):
    write_ply(tmp_path / "a.ply", POINTS)
    np.savetxt(tmp_path / "a.xyz", POINTS)
    np.savez(tmp_path / "a.npz", points_mm=POINTS)
    np.savez(tmp_path / "b.npz", points=POINTS, view=np.zeros(3))
    for name in ("a.ply", "a.xyz", "a.npz", "b.npz"):
        np.testing.assert_allclose(read_file(tmp_path / name), POINTS, atol=1e-6)


@pytest.mark.parametrize("suffix", ["ply", "stl", "obj", "off", "glb", "3mf"])
def test_of_a_mesh_points_are_drawn_evenly_by_area(tmp_path, suffix):
    trimesh.creation.box((2, 4, 8)).export(tmp_path / f"a.{suffix}")
    content = read_cloud(tmp_path / f"a.{suffix}", MANY, np.random.default_rng(0))
    points = content.points
    assert points.shape == (MANY, 3)
    assert content.num_faces == 12
    assert f"a mesh of 12 faces: {MANY} points are drawn of it, evenly by area" in content.warnings
    up = 1 if suffix == "glb" else 2  # glTF has y up, by its standard
    on_top = np.isclose(
        np.abs(points[:, up]), np.abs(points[:, up]).max()
    )  # two faces of 8, of 112 in all
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


def test_points_that_are_not_finite_are_left_out_and_counted(tmp_path):
    rows = np.vstack([[[np.nan, 0, 0]], POINTS, [[0, np.inf, 0]]])
    write_ply(tmp_path / "a.ply", rows)
    np.savetxt(tmp_path / "a.xyz", rows)
    np.savez(
        tmp_path / "a.npz", points_mm=rows, colors=np.arange(156, dtype=np.uint8).reshape(52, 3)
    )
    for name in ("a.ply", "a.xyz", "a.npz"):
        content = read_cloud(tmp_path / name, MANY, np.random.default_rng(0))
        np.testing.assert_allclose(content.points, POINTS, atol=1e-6)
        assert content.warnings == ("2 of its 52 points are not finite and are left out",)
    assert content.colors.tolist()[0] == [3, 4, 5]  # of the row that stays
    np.savez(tmp_path / "a.npz", points_mm=rows[:1])
    with pytest.raises(BadArtifact, match=r"a\.npz cannot be read: none of its 1 points is finite"):
        read_file(tmp_path / "a.npz")


def test_points_that_float32_cannot_hold_are_refused_by_name(tmp_path):
    np.savez(tmp_path / "a.npz", points_mm=np.vstack([POINTS, [[1e300, 0, 0]]]))
    with pytest.raises(
        BadArtifact, match=r"a\.npz cannot be read: 1 of 51 points are too large: .* of 1e\+300"
    ):
        read_file(tmp_path / "a.npz")


def test_what_is_remarked_on_is_the_file_s_points_not_the_rounded_ones(tmp_path):
    """At 1e7 float32 has steps of 1 mm: no side of 0.4 mm is left, and only the step is odd."""
    mesh = solids.box(0.2, 0.3, 0.4)
    mesh = Mesh.with_one_appearance(mesh.vertices + 1e7, mesh.faces)
    save_part(tmp_path / "block", unit_part("block"), mesh)
    np.savez(tmp_path / "far.npz", points_mm=mesh.vertices)
    (tmp_path / "out").mkdir()
    import_points(tmp_path / "far.npz", tmp_path / "block", MANY, 8, 0.0, 0, tmp_path / "out")
    (warnings,) = load_warnings(tmp_path / "out")
    assert "has steps of 1 mm, 2 of the diagonal" in warnings


def test_gaussian_splats_are_their_centers_from_an_opacity_on(tmp_path):
    """Opacity is kept as its logit, color as the first coefficient of spherical harmonics."""
    names = ("x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0")
    table = np.zeros((4, 8), "<f4")
    table[:, :3], table[:, 3] = POINTS[:4], [-1.772, 0, 1.772, 9]  # 0.5 + 0.2821 c: 0, 0.5, 1, 1
    table[:, 6] = np.log([0.05, 0.3, 0.9, 0.99]) - np.log([0.95, 0.7, 0.1, 0.01])
    header = "".join(f"property float {name}\n" for name in names)
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex 4\n{header}end_header\n"
    (tmp_path / "a.ply").write_bytes(head.encode() + table.tobytes())
    content = read_cloud(tmp_path / "a.ply", MANY, np.random.default_rng(0))
    np.testing.assert_allclose(content.points, POINTS[:4], atol=1e-6)
    np.testing.assert_allclose(content.colors[:, 0], [0, 127, 255, 255], atol=1)
    (warning,) = content.warnings
    assert warning.startswith("Gaussian splats: the centers of 4 of 4 are taken as points; 1 of t")
    assert "--min-opacity" in warning
    content = read_cloud(tmp_path / "a.ply", MANY, np.random.default_rng(0), min_opacity=0.5)
    np.testing.assert_allclose(content.points, POINTS[2:4], atol=1e-6)
    assert content.warnings == ("Gaussian splats: the centers of 2 of 4 are taken as points",)
    with pytest.raises(BadArtifact, match="none of its 4 Gaussian splats has an opacity of 1"):
        read_cloud(tmp_path / "a.ply", MANY, np.random.default_rng(0), min_opacity=1.0)


def test_gltf_in_axes_of_its_own_is_taken_as_it_stands_where_that_fits(tmp_path):
    box = trimesh.creation.box((20, 30, 40))
    box.apply_translation((10, 15, 20))
    scaled = box.copy()
    scaled.apply_scale(0.001)  # glTF is in meters
    scaled.export(tmp_path / "own.glb")
    content = read_cloud(tmp_path / "own.glb", MANY, np.random.default_rng(0))
    assert "its unit is m, stated; its points are turned into mm" in content.warnings
    chosen = choose_axes(content, box.vertices)
    np.testing.assert_allclose(np.ptp(chosen.points, axis=0), (20, 30, 40), rtol=1e-2)
    assert "its axes are taken as they stand" in chosen.warnings[-1]
    turned = box.vertices @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    assert choose_axes(content, turned) is content  # the standard's fit
    assert choose_axes(content, box.vertices * 9) is content  # neither does
