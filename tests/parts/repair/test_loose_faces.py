"""A few loose triangles beside a solid take neither its volume nor its bounding box."""

import numpy as np
import pytest

from industnerf.artifacts.part import Mesh
from industnerf.errors import BadPart
from industnerf.parts.repair import repair_mesh
from industnerf.parts.validation.checks import bad_edges
from tests.parts.repair.shapes import (
    ball,
    box,
    concatenated,
    flipped,
    scaled,
    select_faces,
    settings,
    triangle_soup,
    volume,
)

SLIVER = Mesh.with_one_appearance(
    np.array([[200.0, 0, 0], [200.005, 0, 0], [200.005, 300, 0], [200, 300, 0]]),
    np.array([[0, 1, 2], [0, 2, 3]], np.int32),
)  # long, and hardly any area


@pytest.mark.parametrize(
    "solids",
    [
        [box(), SLIVER],  # as a STEP file has it
        [concatenated(box(), SLIVER)],
        [triangle_soup(concatenated(SLIVER, box()))],  # as an STL file has it
    ],
    ids=["apart", "together", "soup"],
)
def test_they_are_dropped_beside_a_closed_solid(solids):
    result = repair_mesh(solids, settings())
    assert volume(result.mesh) == pytest.approx(6000)
    np.testing.assert_allclose(np.ptp(result.mesh.vertices, axis=0), [30, 20, 10])
    assert len(bad_edges(result.mesh.faces)) == 0
    assert result.repairs[0].startswith(
        "loose faces beside the solid removed: 2, 0.07% of the area"
    )
    assert not result.residual_defects


def test_pieces_are_measured_against_the_solid_alone():
    """Against a box that goes around the sliver too, the second ball would be small."""
    solids = [concatenated(ball(10.0), ball(0.6, (13, 0, 0)))]
    alone = repair_mesh(solids, settings())
    both = repair_mesh([*solids, SLIVER], settings())
    np.testing.assert_array_equal(alone.mesh.faces, both.mesh.faces)
    assert both.repairs[1:] == alone.repairs


@pytest.mark.parametrize(
    "solids",
    [
        [select_faces(ball(), slice(1, None)), SLIVER],  # no closed solid
        [box(), box((8, 8, 0.5), (0, 0, 30)), select_faces(box((8, 8, 8), (50, 0, 0)), slice(6))],
        [box((0.4, 0.4, 0.4)), ball(), flipped(box((0.3, 0.3, 0.3)))],  # closed, however small
    ],
    ids=["open", "large", "closed"],
)
def test_others_stay(solids):
    result = repair_mesh(solids, settings(small_component_size=0.0))
    assert len(result.mesh.faces) == sum(len(solid.faces) for solid in solids)


def test_a_small_solid_with_a_crack_is_no_loose_face():
    cracked = select_faces(ball(0.6, (13, 0, 0)), slice(2, None))
    result = repair_mesh([ball(10.0), cracked], settings(small_component_size=0.0))
    assert len(result.mesh.faces) == 638
    assert not result.repairs


def test_degenerate_and_repeated_faces_of_the_solid_do_not_make_it_open():
    solid = box()
    faces = np.concatenate([solid.faces, [[0, 0, 1]], solid.faces[:1]]).astype(np.int32)
    result = repair_mesh([Mesh.with_one_appearance(solid.vertices, faces), SLIVER], settings())
    assert len(result.mesh.faces) == 12


def test_with_no_limit_all_stay():
    assert len(repair_mesh([box(), SLIVER], settings(small_component_area=0.0)).mesh.faces) == 14


def sheets(count, width, distance) -> Mesh:
    """`count` squares in a row along x, the last at `distance`."""
    corners = width * np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    shifts = np.linspace(distance, 200, count)[:, None, None] * [1.0, 0, 0]
    faces = np.array([[0, 1, 2], [0, 2, 3]]) + 4 * np.arange(count)[:, None, None]
    return Mesh.with_one_appearance(
        (corners + shifts).reshape(-1, 3), faces.reshape(-1, 3).astype(np.int32)
    )


def with_gaps(soup: Mesh, gap: float) -> Mesh:
    noise = np.random.default_rng(0).uniform(-gap / 4, gap / 4, soup.vertices.shape)
    return Mesh(soup.vertices + noise, soup.faces, soup.finish)


CUBE = box((100.0, 100.0, 100.0))


@pytest.mark.parametrize("distance", [1e4, 1e6, 1e9])
@pytest.mark.parametrize(
    "solid",
    [CUBE, triangle_soup(CUBE), with_gaps(triangle_soup(CUBE), settings().weld * 100)],
    ids=["closed", "soup", "gaps"],
)
def test_the_scale_of_the_solid_decides_however_far_the_sheet(solid, distance):
    alone = repair_mesh([solid], settings())
    for solids in (
        [solid, sheets(1, 2.0, distance)],
        [concatenated(sheets(1, 2.0, distance), solid)],
    ):
        both = repair_mesh(solids, settings())
        np.testing.assert_array_equal(both.mesh.triangles, alone.mesh.triangles)
        assert both.repairs[0].startswith(
            "loose faces beside the solid removed: 2, 0.01% of the area"
        )
        assert both.repairs[1:] == alone.repairs
        assert not both.residual_defects


def test_too_many_loose_sheets_stay_and_are_named():
    loose = sheets(20, 14.0, 1760)
    result = repair_mesh([CUBE, loose], settings())
    assert len(result.mesh.faces) == 12 + 40
    share = 20 * 14**2 / (20 * 14**2 + 6e4)
    assert result.residual_defects[:2] == (
        f"loose sheets beside a closed solid left: 20 with {share:.2%} of the area, more than "
        "parts.repair.max_removed_area (5.00%); they set the size of the part: the diagonal of "
        "its bounding box is 1829 mm, 173.2 mm without them",
        "open edges: 80",
    )
    allowed = repair_mesh([CUBE, loose], settings(max_removed_area=0.1))
    assert len(allowed.mesh.faces) == 12
    assert not allowed.residual_defects


def test_loose_sheets_within_the_box_of_the_solid_do_not_set_its_size():
    loose = scaled(sheets(20, 14.0, 201), 1.0, (-200.0, 0, 0))
    message = repair_mesh([CUBE, loose], settings()).residual_defects[0]
    assert message.startswith("loose sheets beside a closed solid left: ")
    assert message.endswith("parts.repair.max_removed_area (5.00%)")


def test_a_part_that_too_many_far_sheets_make_a_point_is_refused_with_the_knob():
    with pytest.raises(BadPart, match=r"lie on a line.*; loose sheets .* 20 .*max_removed_area"):
        repair_mesh([CUBE, sheets(20, 14.0, 1e6)], settings())
