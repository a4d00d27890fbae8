"""A few loose triangles beside a solid take neither its volume nor its bounding box."""

import numpy as np
import pytest

from industnerf.artifacts.part import Mesh
from industnerf.parts.repair import repair_mesh
from industnerf.parts.validation.checks import bad_edges
from tests.parts.repair.shapes import (
    ball,
    box,
    concatenated,
    flipped,
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
