"""Asked about a part that it has learned from, retrieval finds that part."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.part import Mesh
from industnerf.capture.photograph import photograph
from industnerf.geometry.boxes import Cube
from industnerf.learning.pictures import scaled
from industnerf.methods import load_method
from industnerf.methods.base import Example, Given, hand_over
from industnerf.methods.retrieval import distances, features
from industnerf.schema import Params, RetrievalSettings
from tests.methods.conftest import save_as_part

RETRIEVAL = load_method("retrieval")
SETTINGS = RetrievalSettings(views=6, image_px=32, points=500)
PLACES = {"ball": (3.0, (0, 0, 0)), "bar": (40.0, (10, 20, 30)), "plate": (900.0, (-500, 0, 0))}


def shape(name: str) -> trimesh.Trimesh:
    """In the unit cube."""
    if name == "ball":
        return trimesh.creation.icosphere(3, 0.5)
    return trimesh.creation.box({"bar": (0.2, 0.3, 1.0), "plate": (1.0, 1.0, 0.1)}[name])


def beyond(name: str, points: np.ndarray) -> np.ndarray:
    """How far points of the unit cube are out of the solid; negative inside."""
    if name == "ball":
        return np.linalg.norm(points, axis=1) - 0.5
    return (np.abs(points) - shape(name).extents / 2).max(axis=1)


@pytest.fixture(scope="module")
def parts(tmp_path_factory: pytest.TempPathFactory, params: Params) -> Path:
    """Folders with `part` and `views`, one a shape, each at its place and scale."""
    root = tmp_path_factory.mktemp("parts")
    small = replace(params.views, count=8, held_out=1, resolution=48, edge_samples=1)
    for name, (scale, shift) in PLACES.items():
        (root / name).mkdir()
        mesh = shape(name)
        vertices = scale * np.array(mesh.vertices, float) + shift
        save_as_part(root / name / "part", Mesh.plain(vertices, mesh.faces.astype(np.int32)))
        photograph(root / name / "part", root / name / "views", small, params.seed)
    return root


@pytest.fixture(scope="module")
def learned(parts):
    examples = [
        Example(name, parts / name / "part", parts / name / "views", RETRIEVAL.inputs)
        for name in PLACES
    ]
    return RETRIEVAL.fit(examples, SETTINGS, 1, parts)


def given(folder: Path) -> Given:
    return hand_over(RETRIEVAL, folder / "part", folder / "views")


@pytest.mark.parametrize("name", PLACES)
def test_a_part_that_was_learned_from_is_found_at_its_place_and_scale(name, parts, learned):
    points = RETRIEVAL.reconstruct(given(parts / name), SETTINGS, learned, 1).points_mm
    scale, shift = PLACES[name]
    # An edge of the ball's triangles is up to 0.082 long, centres are up to 0.577 of that from the
    # corners, where it sags by (0.577 * 0.082)^2 / (2 * 0.5) = 2.2e-3; float32 is exact to 1e-7.
    slack = 2.5e-3 if name == "ball" else 1e-6
    np.testing.assert_allclose(beyond(name, (points - shift) / scale), 0, atol=slack)
    assert len(points) == 500


def test_its_points_are_scaled_to_the_part_asked_about(parts, learned):
    asked = given(parts / "bar")
    frame = Cube(np.array([1.0, 2.0, 3.0]), 5.0)
    moved = replace(asked, handed={**asked.handed, "frame": frame})
    points = RETRIEVAL.reconstruct(moved, SETTINGS, learned, 1).points_mm
    np.testing.assert_allclose(beyond("bar", (points - [1, 2, 3]) / 5), 0, atol=1e-6)


@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_fewer_views_are_compared_with_those_from_the_same_side(count, parts, learned):
    """They are chosen otherwise than those learned from: nested, not by number."""
    for name in PLACES:
        asked = hand_over(RETRIEVAL, parts / name / "part", parts / name / "views", count)
        looks = features(scaled(asked.rgb, SETTINGS.image_px))
        both = np.isin(asked.chosen, learned.arrays["views"])
        there = np.searchsorted(learned.arrays["views"], asked.chosen[both])
        own = learned.arrays["features"][list(PLACES).index(name), there]
        np.testing.assert_array_equal(looks[both], own)
        points = RETRIEVAL.reconstruct(asked, SETTINGS, learned, 1).points_mm
        scale, shift = PLACES[name]
        np.testing.assert_allclose(beyond(name, (points - shift) / scale), 0, atol=2.5e-3)


def test_distances_are_summed_view_by_view():
    rng = np.random.default_rng(0)
    theirs = rng.random((4, 3, 5), np.float32)
    mine = rng.random((3, 5), np.float32)
    expected = [
        sum(
            float(((a.astype(float) - b) ** 2).sum()) ** 0.5 for a, b in zip(one, mine, strict=True)
        )
        for one in theirs
    ]
    np.testing.assert_allclose(distances(theirs, mine), expected, rtol=1e-5)  # float32


def test_features_tell_edges_and_not_how_bright_a_picture_is():
    rng = np.random.default_rng(0)
    picture = rng.integers(0, 100, (1, 32, 32, 3), np.uint8)
    looks = features(np.concatenate([picture, 2 * picture, picture.swapaxes(1, 2)]))
    # Blocks are normalised, but for an epsilon beside gradients of about 0.1.
    assert np.linalg.norm(looks[0] - looks[1]) < 1e-3 * np.linalg.norm(looks[0])
    assert np.linalg.norm(looks[0] - looks[2]) > 0.3 * np.linalg.norm(looks[0])
