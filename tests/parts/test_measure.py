"""Facts of solids known in closed form, and of what is no solid."""

import numpy as np
import pytest

from industnerf.artifacts.part import Mesh
from industnerf.errors import BadPart
from industnerf.parts.measure import measure, round_significant, visible_share
from tests.solids import ball, box, combine_meshes, cup, transform_mesh, tube


def test_a_box():
    facts = measure(box(2, 3, 5))
    assert facts.extents_mm == (2, 3, 5)
    assert facts.area_mm2 == pytest.approx(62, rel=1e-9)
    assert facts.volume_mm3 == pytest.approx(30, rel=1e-9)
    assert (facts.bodies, facts.faces, facts.euler_number, facts.through_holes) == (1, 12, 2, 0)
    assert (facts.visible_share, facts.hull_hidden_share, facts.strata) == (1, 0, ())


def test_a_tube_has_one_hole_and_two_tubes_have_two():
    one = tube(5, 7, 20)
    assert (measure(one).euler_number, measure(one).through_holes) == (0, 1)
    two = measure(combine_meshes(one, transform_mesh(one, offset=(30, 0, 0))))
    assert (two.bodies, two.euler_number, two.through_holes) == (2, 0, 2)


def test_the_inside_of_a_cup_is_seen_but_not_by_silhouettes():
    """The sphere of eyes looks into a cup that no deeper than wide it sees all of."""
    facts = measure(cup(inner=8, outer=10, floor=2, height=10))
    assert facts.visible_share == 1
    # 2 pi r h + pi r^2 of all, 603 of 1646 mm2; five standard errors of 4096 samples
    assert facts.hull_hidden_share == pytest.approx(603 / 1646, abs=0.038)


def test_cameras_stand_two_diagonals_from_the_middle_of_the_box(monkeypatch):
    calls = []

    def visible_from(scene, points, cameras, tolerance_mm):
        calls.append(cameras)
        return np.arange(len(points)) % 4 == 0

    monkeypatch.setattr("industnerf.parts.measure.visible_from", visible_from)
    assert visible_share(transform_mesh(box(2, 3, 6), offset=(10, 20, 30))) == 0.25
    (cameras,) = calls
    np.testing.assert_allclose(np.linalg.norm(cameras - [10, 20, 30], axis=1), 2 * 7, rtol=1e-12)
    assert len(cameras) == 100


def test_a_hollow_hides_its_wall():
    inner = ball(5)
    inside = Mesh.with_one_appearance(inner.vertices, np.ascontiguousarray(inner.faces[:, ::-1]))
    facts = measure(combine_meshes(ball(10), inside))
    # A fifth of the area, 25 / (100 + 25); five standard errors of 4096 samples
    assert 1 - facts.visible_share == pytest.approx(0.2, abs=0.032)
    assert facts.volume_mm3 == pytest.approx(measure(ball(10)).volume_mm3 * 7 / 8, rel=1e-9)


def test_an_open_mesh_has_no_volume_and_no_holes():
    whole = box(2, 2, 2)
    facts = measure(Mesh.with_one_appearance(whole.vertices, whole.faces[1:]))
    assert facts.volume_mm3 is None
    assert facts.through_holes is None
    assert facts.area_mm2 == pytest.approx(24 - 2, rel=1e-9)


def test_a_sheet_with_two_sides_is_thin_and_without_volume():
    corners = np.array([[0.0, 0, 0], [4, 0, 0], [4, 3, 0]])
    facts = measure(Mesh.with_one_appearance(corners, np.array([[0, 1, 2], [0, 2, 1]], np.int32)))
    assert facts.volume_mm3 == 0
    assert facts.extents_mm == (4, 3, 0)
    assert "thin" in facts.strata


@pytest.mark.parametrize("scale", [1e-7, 1e6])
def test_no_size_is_rounded_away(scale):
    facts = measure(transform_mesh(box(2, 3, 5), scale=scale))
    assert facts.extents_mm == pytest.approx((2 * scale, 3 * scale, 5 * scale), rel=1e-9)
    assert facts.area_mm2 == pytest.approx(62 * scale**2, rel=1e-9)
    assert facts.volume_mm3 == pytest.approx(30 * scale**3, rel=1e-9)


def test_digits_and_not_decimals_are_kept():
    assert round_significant(1.23456789012e-9) == 1.23456789e-9
    assert round_significant(123456789012.0) == 123456789000.0
    assert round_significant(0.0) == 0.0


def test_without_area_there_is_no_part():
    line = Mesh.with_one_appearance(
        np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]), np.array([[0, 1, 2]], np.int32)
    )
    with pytest.raises(BadPart, match="1 faces and no area"):
        measure(line)
