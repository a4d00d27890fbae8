"""What the viewer is given: the points themselves, their true distances, and nothing made up."""

import base64
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from industnerf.artifacts.truth import Truth
from industnerf.report.scenes import CAP, POINTS, SPAN, WORST, scene
from tests.report import gallery

KINDS = {"place": ("<u2", 3), "view": ("<u2", 1), "colour": ("u1", 3)}
STEP = SPAN * gallery.DIAGONAL / 65535  # mm


def decode(cloud: dict) -> dict[str, np.ndarray]:
    """The arrays of a packed cloud."""
    found = {}
    for name, text in cloud["arrays"].items():
        kind, width = KINDS.get(name, ("u1", 1))
        flat = np.frombuffer(base64.b64decode(text), kind)
        found[name] = flat.reshape(-1, width).squeeze()
    return found


def places_mm(steps: np.ndarray) -> np.ndarray:
    """Positions from steps, as viewer.js has them, about the part's centre."""
    return (steps / 65535 - 0.5) * SPAN * gallery.DIAGONAL + gallery.CENTRE


def distances_mm(roots: np.ndarray) -> np.ndarray:
    """Distances from roots, as colours.js has them."""
    return WORST * gallery.DIAGONAL * (roots / 255) ** 2


@pytest.fixture
def packed(study):
    return scene(study, study.parts["near-ball"]).clouds


def test_points_are_where_they_were_to_half_a_step_in_one_frame(packed):
    offset = {
        name: gallery.points(2000, radius) - places_mm(decode(packed[name])["place"])
        for name, radius in (("truth", 10.0), ("oracle", 10.0), ("hull", 10.2))
    }
    centre = offset["truth"].mean(axis=0)  # of the samples' box, not quite the ball's
    for found in offset.values():
        assert len(found) == 2000
        assert np.abs(found - centre).max() < 0.55 * STEP


def test_distances_are_to_the_surface_and_back_to_the_whole_cloud(study, packed):
    true = gallery.points(2000, 10.0)
    hull = decode(packed["hull"])
    found, limit = distances_mm(hull["error"]), WORST * gallery.DIAGONAL
    # the surface is a polyhedron: between its corners, 0.8 mm apart, it is up to 0.02 mm deeper
    slack = limit * (np.sqrt(gallery.FAR / limit) + 1 / 510) / 255
    assert found.min() > gallery.FAR - slack
    assert found.max() < gallery.FAR + 0.02 + slack
    missed = cKDTree(gallery.points(2000, 10.2)).query(true)[0]
    assert distances_mm(hull["missed"]).mean() == pytest.approx(missed.mean(), rel=0.02)
    assert decode(packed["oracle"])["error"].max() == 0


def test_what_a_method_says_is_kept_and_what_it_does_not_say_is_left_out(packed):
    hull = decode(packed["hull"])
    np.testing.assert_allclose(hull["confidence"] / 255, np.linspace(0, 1, 2000), atol=0.5 / 255)
    np.testing.assert_array_equal(hull["view"], np.arange(2000) % 5 + 1)
    np.testing.assert_array_equal(hull["colour"][-1], [200, 200, 200])
    assert set(packed["oracle"]["arrays"]) == {"place", "error", "missed"}


def test_a_cloud_that_is_not_there_says_why(study, packed):
    assert packed["box"]["failed"] == gallery.BROKEN
    assert packed["box"]["arrays"] == {}
    untold = replace(study, failures={})
    assert scene(untold, study.parts["near-ball"]).clouds["box"]["failed"] == "it made no cloud"


def test_of_many_points_a_few_are_spread_evenly_and_equally_in_every_run(tmp_path):
    gallery.lay_out(tmp_path, "near-ball", CAP + 1)
    many = gallery.study(tmp_path)
    (one, again) = (scene(many, many.parts["near-ball"]).clouds["oracle"] for _ in range(2))
    assert one == again
    assert one["count"] == POINTS
    assert one["says"] == f"{POINTS} of {CAP + 1} points"
    places = decode(one)["place"] * STEP
    apart = cKDTree(places).query(places, 2)[0][:, 1]
    # a hexagonal lattice has 1.07 of this side between neighbours, a random cloud 0.5 on average
    side = np.sqrt(4 * np.pi * gallery.RADIUS**2 / POINTS)
    assert apart.min() > 0.6 * side


def test_points_outside_the_picture_are_counted(study, tmp_path):
    gallery.lay_out(tmp_path, "near-ball")
    where = gallery.points(2000, 10.0)
    where[:7] += np.float32(10 * gallery.DIAGONAL)
    gallery.cloud("near-ball", where, telling=False).save(tmp_path / "hull" / "near-ball")
    few = gallery.study(tmp_path)
    found = scene(few, few.parts["near-ball"]).clouds["hull"]
    assert found["says"] == "1993 of 2000 points; 7 more lie outside the picture"
    assert len(decode(found)["error"]) == found["count"] == 1993


def test_an_empty_cloud_is_no_reason_to_fall_over(tmp_path):
    gallery.lay_out(tmp_path, "near-ball")
    nothing = np.zeros((0, 3), np.float32)
    gallery.cloud("near-ball", nothing, telling=False).save(tmp_path / "hull" / "near-ball")
    few = gallery.study(tmp_path)
    found = scene(few, few.parts["near-ball"]).clouds["hull"]
    assert (found["count"], found["says"]) == (0, "0 of 0 points")
    assert set(decode(found)["missed"]) == {255}


def test_the_truth_says_what_is_hidden(study, packed):
    known = Truth.load(study.folders.truth / "near-ball")
    np.testing.assert_array_equal(decode(packed["truth"])["visible"], known.visible)
