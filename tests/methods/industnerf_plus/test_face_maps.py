"""Mouths in a face are where the views do not agree; a label is none."""

import numpy as np
import pytest

from industnerf.methods.industnerf_plus.face_maps import (
    RASTER,
    FaceMap,
    _even_level,
    _look_up_views,
    _median_levels,
    _round_outline,
    end_lattice,
    map_face,
)
from industnerf.methods.industnerf_plus.faces import Face
from industnerf.methods.industnerf_plus.pictures import Pictures
from industnerf.methods.industnerf_plus.recesses import hull_thickness
from industnerf.methods.industnerf_plus.shaded_surface import PinholeRays
from industnerf.methods.industnerf_plus.trials import Trials

from .plugged_block import (
    BLOCK,
    CENTERED,
    HALF_WIDTH,
    POCKET,
    SIZE,
    TOP,
    VIEWS,
    photographs,
    photographs_of,
    surface_of,
)

MIDDLE = (SIZE - 1) / 2
TOP_FACE = Face(np.array([0.0, 0.0, 1.0]), TOP + MIDDLE, 1000)


def mapped(pictures: Pictures, face: Face = TOP_FACE) -> FaceMap | None:
    surface = surface_of(BLOCK)
    trials = Trials(surface, PinholeRays(VIEWS, np.zeros(3), 1.0, surface.grid), pictures)
    return map_face(trials, face, end_lattice(trials), 0.03)


@pytest.fixture(scope="module")
def pocket_map() -> FaceMap:
    return mapped(photographs(np.maximum(BLOCK, -POCKET)))


def test_a_mouth_is_where_the_pocket_is(pocket_map):
    """To a cell of blurred normals at its rim, one entry, and what the smoothing adds."""
    (outline,) = pocket_map.mouths()
    points = pocket_map.points(outline > 0) - MIDDLE
    np.testing.assert_allclose(points[:, 2], TOP, atol=1e-9)
    for axis, center in ((0, 1.0), (1, 0.5)):
        assert points[:, axis].min() == pytest.approx(center - HALF_WIDTH, abs=2.3)
        assert points[:, axis].max() == pytest.approx(center + HALF_WIDTH, abs=2.3)


def test_outlines_are_looked_up_where_they_are(pocket_map):
    (outline,) = pocket_map.mouths()
    points = pocket_map.points(outline > 0).astype(np.float32)
    above = points + np.array([0, 0, 5], np.float32)
    found = pocket_map.look_up(outline, above)
    np.testing.assert_allclose(found, outline[outline > 0], atol=1e-3)
    np.testing.assert_allclose(pocket_map.height(above), 5, atol=1e-4)
    assert pocket_map.look_up(outline, np.array([[-500, 0, 0]], np.float32)) < -5


def test_a_plain_face_has_no_mouth():
    plain = mapped(photographs(BLOCK))
    assert not plain.mouths()
    assert plain.is_face[plain.is_section].mean() > 0.85  # all but its border


def test_a_label_is_no_mouth():
    """It looks unlike the face, but alike from everywhere."""
    truth = surface_of(BLOCK)
    is_label = np.linalg.norm(CENTERED[..., :2] - [2, 1], axis=-1) < 6
    albedo = np.repeat(np.where(is_label, 0.6, 1.0)[..., None], 3, axis=-1)
    truth.set_node_albedo(albedo.astype(np.float32))
    labeled = mapped(photographs_of(truth))
    assert not labeled.mouths()
    label = np.linalg.norm(labeled.points(labeled.is_section)[:, :2] - MIDDLE - [2, 1], axis=1)
    assert not labeled.is_face[labeled.is_section][label < 4].any()


def test_a_plane_inside_the_part_is_no_face():
    assert mapped(photographs(BLOCK), Face(TOP_FACE.normal, MIDDLE, 1000)) is None


def test_a_groove_to_the_border_of_the_face_is_a_gap():
    """The hull knows of it at the face, and not behind a wall at its far end."""
    groove = np.maximum(np.abs(CENTERED[..., 0]) - 4, 3 - CENTERED[..., 2])
    surface = surface_of(BLOCK)
    end = CENTERED[..., 1] > 10
    surface.grid.hull[:] = np.where(end, np.maximum(surface.grid.hull, -groove), surface.grid.hull)
    pictures = photographs(np.maximum(BLOCK, -groove))
    trials = Trials(surface, PinholeRays(VIEWS, np.zeros(3), 1.0, surface.grid), pictures)
    face = Face(np.array([0.0, 1.0, 0.0]), 15.3 + MIDDLE, 1000)
    face_map = map_face(trials, face, end_lattice(trials), 0.03)
    (outline,) = face_map.gaps()
    assert (outline > 0).sum() * RASTER**2 == pytest.approx(8 * (TOP - 3), rel=0.4)
    assert hull_thickness(trials, face_map, outline) == pytest.approx(30, abs=2.5)


def test_levels_are_medians_and_modes_of_what_is_seen():
    gray = np.array([[0.5, 0.2], [0.5, 0.9], [0.5, 0.21], [0.1, -1.0]])
    weight = np.array([[1.0, 1.0], [1.0, 1.0], [0.5, 1.0], [0.0, 0.0]])
    np.testing.assert_allclose(_median_levels(gray, weight), [0.5, 0.21])
    assert _even_level(gray[:, :1], weight[:, :1], 0.03) == 0.5
    assert _even_level(gray[:, 1:], weight[:, 1:], 0.03) == pytest.approx(0.205)
    assert _even_level(np.linspace(0, 1, 40)[:, None], np.ones((40, 1)), 0.03) is None
    assert _even_level(gray, np.zeros_like(gray), 0.03) is None


def plain_map(other_share: np.ndarray, is_face: np.ndarray) -> FaceMap:
    """A map that is all section, one entry a cell apart along x and y."""
    everywhere = np.ones(other_share.shape, bool)
    axes = np.eye(3)[:2]
    return FaceMap(
        TOP_FACE, axes, np.zeros(2), everywhere, ~everywhere, is_face, other_share.astype(float)
    )


def test_the_outline_of_a_disc_is_one_and_that_of_a_square_its_own():
    """A raster of a disc of 9 entries is off by up to half an entry, its area by 1 %."""
    u, v = np.indices((60, 60)) - 30.0
    for mask, inside, outside in (
        (np.hypot(u, v) < 9, (9 - np.hypot(u, v)) * RASTER, 0.15),
        (np.maximum(abs(u), abs(v)) < 9, (9 - np.maximum(abs(u), abs(v))) * RASTER, 0.75),
    ):
        (outline,) = plain_map(mask, ~mask).mouths()
        near = np.abs(inside) < 2
        tolerance = outside + RASTER  # smoothing moves a border by up to an entry
        assert np.abs(outline - inside)[near & (np.minimum(abs(u), abs(v)) < 4)].max() < tolerance
    round_away = np.abs(_round_outline(np.hypot(u, v) < 9) - RASTER * (9 - np.hypot(u, v)))
    assert round_away.max() < 0.1


def test_a_mouth_without_a_rim_of_face_is_none():
    """What is about it looks like no face on three quarters of the way round."""
    u, v = np.indices((60, 60)) - 30.0
    mask = np.hypot(u, v) < 9
    assert len(plain_map(mask, ~mask).mouths()) == 1
    assert plain_map(mask, ~mask & (u > 0) & (v > 0)).mouths() == []


def test_what_matter_before_the_plane_hides_does_not_count():
    surface = surface_of(BLOCK)
    pictures = photographs(BLOCK)
    trials = Trials(surface, PinholeRays(VIEWS, np.zeros(3), 1.0, surface.grid), pictures)
    point = np.array([[MIDDLE, MIDDLE, TOP_FACE.offset]])
    ends = end_lattice(trials)
    _, open_weight = _look_up_views(trials, TOP_FACE, point, ends)
    distance = np.linalg.norm(trials.rays.centers - point, axis=1)
    for before, is_hidden in ((0.5, False), (20.0, True)):
        nearer = np.where(ends >= 0, (distance - before)[:, None, None], ends)
        _, weight = _look_up_views(trials, TOP_FACE, point, nearer.astype(np.float32))
        assert open_weight.any()
        np.testing.assert_allclose(weight, 0 if is_hidden else open_weight)
