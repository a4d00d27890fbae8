"""What the viewer is given: the points themselves, their true distances, and nothing made up."""

import base64
import zlib
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from industnerf.artifacts.truth import Truth
from industnerf.report.html.viewer import (
    MAX_ERROR,
    MAX_POINTS,
    SHOWN_POINTS,
    SPAN,
    STEPS,
    pack_scene,
    z_order,
)
from tests.report import ball_study

KINDS = {"positions": ("<u2", 3), "view": ("<u2", 1), "color": ("u1", 3)}
STEP = SPAN * ball_study.DIAGONAL_MM / STEPS  # mm


def decode(cloud: dict) -> dict[str, np.ndarray]:
    """The arrays of a packed cloud."""
    arrays = {}
    for name, text in cloud["arrays"].items():
        kind, width = KINDS.get(name, ("u1", 1))
        planes = np.frombuffer(zlib.decompress(base64.b64decode(text)), "u1")
        flat = planes.reshape(np.dtype(kind).itemsize, -1).T.copy().view(kind).ravel()
        if name == "positions":
            arrays[name] = np.cumsum(flat.reshape(3, -1), axis=1, dtype="u2").T
        else:
            arrays[name] = flat.reshape(-1, width).squeeze()
    return arrays


def places_mm(steps: np.ndarray) -> np.ndarray:
    """Positions from steps, as viewer.js has them, about the part's center."""
    return (steps / STEPS - 0.5) * SPAN * ball_study.DIAGONAL_MM + ball_study.CENTER


def nearest(points: np.ndarray, shown: np.ndarray) -> np.ndarray:
    """The index in `points` of each point that is shown; every point is shown once."""
    order = cKDTree(points).query(shown)[1]
    assert sorted(order) == list(range(len(points)))
    return order


def distances_mm(roots: np.ndarray) -> np.ndarray:
    """Distances from roots, as colors.js has them."""
    return MAX_ERROR * ball_study.DIAGONAL_MM * (roots / 255) ** 2


@pytest.fixture
def packed(study):
    return pack_scene(study, study.parts["near-ball"]).clouds


def test_points_are_where_they_were_to_half_a_step_in_one_frame(packed):
    offset = {}
    for name, radius in (("truth", 10.0), ("oracle", 10.0), ("hull", 10.2)):
        points, shown = (
            ball_study.points(2000, radius),
            places_mm(decode(packed[name])["positions"]),
        )
        offset[name] = points[nearest(points, shown)] - shown
    center = offset["truth"].mean(axis=0)  # of the samples' box, not quite the ball's
    for differences in offset.values():
        assert len(differences) == 2000
        assert np.abs(differences - center).max() < 0.55 * STEP


def test_distances_are_to_the_surface_and_back_to_the_whole_cloud(study, packed):
    surface_points = ball_study.points(2000, 10.0)
    hull = decode(packed["hull"])
    errors_mm, limit = distances_mm(hull["error"]), MAX_ERROR * ball_study.DIAGONAL_MM
    # the surface is a polyhedron: between its corners, 0.8 mm apart, it is up to 0.02 mm deeper
    slack = limit * (np.sqrt(ball_study.HULL_OFFSET_MM / limit) + 1 / 510) / 255
    assert errors_mm.min() > ball_study.HULL_OFFSET_MM - slack
    assert errors_mm.max() < ball_study.HULL_OFFSET_MM + 0.02 + slack
    missed = cKDTree(ball_study.points(2000, 10.2)).query(surface_points)[0]
    assert distances_mm(hull["missed"]).mean() == pytest.approx(missed.mean(), rel=0.02)
    assert decode(packed["oracle"])["error"].max() == 0


def test_what_a_method_says_is_kept_and_what_it_does_not_say_is_left_out(packed):
    hull = decode(packed["hull"])
    order = nearest(ball_study.points(2000, 10.2), places_mm(hull["positions"]))
    confidence = np.linspace(0, 1, 2000)[order]
    np.testing.assert_allclose(hull["confidence"] / 255, confidence, atol=0.5 / 255)
    np.testing.assert_array_equal(hull["view"], order % 5 + 1)
    np.testing.assert_array_equal(hull["color"][np.argmax(order)], [200, 200, 200])
    assert set(packed["oracle"]["arrays"]) == {"positions", "error", "missed"}


def test_a_cloud_that_is_not_there_says_why(study, packed):
    assert packed["box"]["failed"] == ball_study.FAILURE
    assert packed["box"]["arrays"] == {}
    without_reason = replace(study, failures={})
    assert (
        pack_scene(without_reason, study.parts["near-ball"]).clouds["box"]["failed"]
        == "it made no cloud"
    )


def test_of_many_points_a_few_are_spread_evenly_and_equally_in_every_run(tmp_path):
    ball_study.write_part(tmp_path, "near-ball", MAX_POINTS + 1)
    many = ball_study.study(tmp_path)
    (one, again) = (pack_scene(many, many.parts["near-ball"]).clouds["oracle"] for _ in range(2))
    assert one == again
    assert one["count"] == SHOWN_POINTS
    assert one["caption"] == f"{SHOWN_POINTS} of {MAX_POINTS + 1} points"
    places = decode(one)["positions"] * STEP
    apart = cKDTree(places).query(places, 2)[0][:, 1]
    # a hexagonal lattice has 1.07 of this side between neighbors, a random cloud 0.5 on average
    side = np.sqrt(4 * np.pi * ball_study.RADIUS_MM**2 / SHOWN_POINTS)
    assert apart.min() > 0.6 * side


def test_points_outside_the_viewer_are_counted(study, tmp_path):
    ball_study.write_part(tmp_path, "near-ball")
    points_mm = ball_study.points(2000, 10.0)
    points_mm[:7] += np.float32(10 * ball_study.DIAGONAL_MM)
    ball_study.cloud("near-ball", points_mm, is_varied=False).save(tmp_path / "hull" / "near-ball")
    sparse = ball_study.study(tmp_path)
    packed_cloud = pack_scene(sparse, sparse.parts["near-ball"]).clouds["hull"]
    assert packed_cloud["caption"] == "1993 of 2000 points; 7 more lie outside the viewer"
    assert len(decode(packed_cloud)["error"]) == packed_cloud["count"] == 1993


def test_an_empty_cloud_is_no_reason_to_fall_over(tmp_path):
    ball_study.write_part(tmp_path, "near-ball")
    no_points = np.zeros((0, 3), np.float32)
    ball_study.cloud("near-ball", no_points, is_varied=False).save(tmp_path / "hull" / "near-ball")
    sparse = ball_study.study(tmp_path)
    packed_cloud = pack_scene(sparse, sparse.parts["near-ball"]).clouds["hull"]
    assert (packed_cloud["count"], packed_cloud["caption"]) == (0, "0 of 0 points")
    assert set(decode(packed_cloud)["missed"]) == {255}


def test_the_truth_says_what_is_hidden(study, packed):
    known = Truth.load(study.folders.truth / "near-ball")
    truth = decode(packed["truth"])
    order = nearest(known.points_mm, places_mm(truth["positions"]))
    np.testing.assert_array_equal(truth["visible"], known.visible[order])


def test_neighbors_in_space_are_neighbors_in_z_order():
    """By the definition: bits of the axes in turn, the highest first."""
    steps = np.random.default_rng(0).integers(0, STEPS + 1, (500, 3)).astype(float)

    def code(point):
        bits = [format(int(axis), "014b") for axis in point]
        return "".join(bit for triple in zip(*bits, strict=True) for bit in triple)

    by_code = sorted(range(500), key=lambda i: code(steps[i]))
    np.testing.assert_array_equal(z_order(steps), by_code)
