"""Asked about a part that it has learned from, retrieval finds that part, or that solid."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.part import Mesh
from industnerf.capture.render import render_part
from industnerf.geometry.bounding_cube import BoundingCube
from industnerf.learning.procedural_shapes import ProceduralArrays, ProceduralShape
from industnerf.learning.training_shape import Prior
from industnerf.learning.views import resize_images
from industnerf.methods import load_method
from industnerf.methods.base import Example, Input, MethodInputs, load_inputs
from industnerf.methods.retrieval import (
    even_points,
    feature_distances,
    from_bytes,
    hog_features,
    to_bytes,
)
from industnerf.schema import Params, RetrievalSettings
from tests.methods.conftest import save_as_part

RETRIEVAL = load_method("retrieval")
PROCEDURAL = load_method("retrieval_procedural")
SOLID_VIEWS = 4  # fewer than parts have
SETTINGS = RetrievalSettings(views=6, image_px=32, points=500)
OFFSETS = {"ball": (3.0, (0, 0, 0)), "bar": (40.0, (10, 20, 30)), "plate": (900.0, (-500, 0, 0))}


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
    for name, (scale, shift) in OFFSETS.items():
        (root / name).mkdir()
        mesh = shape(name)
        vertices = scale * np.array(mesh.vertices, float) + shift
        save_as_part(
            root / name / "part", Mesh.with_one_appearance(vertices, mesh.faces.astype(np.int32))
        )
        render_part(root / name / "part", root / name / "views", small, params.seed)
    return root


@pytest.fixture(scope="module")
def fitted_state(parts):
    examples = [
        Example(name, name, parts / name / "part", parts / name / "views", RETRIEVAL.inputs)
        for name in OFFSETS
    ]
    return RETRIEVAL.fit(examples, SETTINGS, 1, parts)


def solid_like(folder: Path, name: str) -> ProceduralShape:
    """What the stage `procedural` stores of a solid, of a part that was rendered."""
    part = Example(name, name, folder / "part", folder / "views", frozenset(Input))
    rng = np.random.default_rng(5)
    pool = part.occupancy_pool(64, rng)
    rows = (
        part.rgb(32, SOLID_VIEWS),
        part.background(SOLID_VIEWS).astype(np.float32),
        part.picture_frames(SOLID_VIEWS).astype(np.float32),
        part.filled_shares(),
        pool.points,
        pool.shares,
        part.surface_pool(rng).astype(np.float16),
    )
    return ProceduralShape(
        name, name, name, None, ProceduralArrays(*(row[None] for row in rows)), 0
    )


@pytest.fixture(scope="module")
def state_with_solids(parts):
    """The ball is a part, bar and plate are solids."""
    ball = parts / "ball"
    examples = [Example("ball", "ball", ball / "part", ball / "views", PROCEDURAL.inputs)]
    solids = [solid_like(parts / name, name) for name in ("bar", "plate")]
    return PROCEDURAL.fit(examples, SETTINGS, 1, parts, Prior(solids))


def inputs_of(folder: Path) -> MethodInputs:
    return load_inputs(RETRIEVAL, folder / "part", folder / "views")


@pytest.mark.parametrize("name", OFFSETS)
def test_a_part_that_was_learned_from_is_found_at_its_place_and_scale(name, parts, fitted_state):
    points = RETRIEVAL.reconstruct(inputs_of(parts / name), SETTINGS, fitted_state, 1).points_mm
    scale, shift = OFFSETS[name]
    # An edge of the ball's triangles is up to 0.082 long, centers are up to 0.577 of that from the
    # corners, where it sags by (0.577 * 0.082)^2 / (2 * 0.5) = 2.2e-3; float32 is exact to 1e-7.
    slack = 2.5e-3 if name == "ball" else 1e-6
    np.testing.assert_allclose(beyond(name, (points - shift) / scale), 0, atol=slack)
    assert len(points) == 500


def test_its_points_are_scaled_to_the_part_asked_about(parts, fitted_state):
    inputs = inputs_of(parts / "bar")
    frame = BoundingCube(np.array([1.0, 2.0, 3.0]), 5.0)
    moved = replace(inputs, loaded={**inputs.loaded, "frame": frame})
    points = RETRIEVAL.reconstruct(moved, SETTINGS, fitted_state, 1).points_mm
    np.testing.assert_allclose(beyond("bar", (points - [1, 2, 3]) / 5), 0, atol=1e-6)


@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_fewer_views_are_compared_with_those_from_the_same_side(count, parts, fitted_state):
    """They are chosen otherwise than those learned from: nested, not by number."""
    for name in OFFSETS:
        inputs = load_inputs(RETRIEVAL, parts / name / "part", parts / name / "views", count)
        query_features = hog_features(resize_images(inputs.rgb, SETTINGS.image_px))
        known = list(fitted_state.arrays["views"])
        both = np.isin(inputs.view_indices, known)
        stored = [known.index(view) for view in inputs.view_indices[both]]
        own_features = fitted_state.arrays["features"][list(OFFSETS).index(name), stored]
        np.testing.assert_array_equal(query_features[both], own_features)
        points = RETRIEVAL.reconstruct(inputs, SETTINGS, fitted_state, 1).points_mm
        scale, shift = OFFSETS[name]
        np.testing.assert_allclose(beyond(name, (points - shift) / scale), 0, atol=2.5e-3)


@pytest.mark.parametrize("count", [0, 1, 3])
@pytest.mark.parametrize("name", OFFSETS)
def test_a_procedural_solid_is_found_as_a_part_is(name, count, parts, state_with_solids):
    """By the views that both have, whether all are given or few."""
    inputs = load_inputs(PROCEDURAL, parts / name / "part", parts / name / "views", count)
    points = PROCEDURAL.reconstruct(inputs, SETTINGS, state_with_solids, 1).points_mm
    scale, shift = OFFSETS[name]
    # a byte is exact to 1/508 along each axis; the ball sags as above
    slack = 3**0.5 / 508 + (2.5e-3 if name == "ball" else 0.0)
    np.testing.assert_allclose(beyond(name, (points - shift) / scale), 0, atol=slack)
    assert len(points) == 500
    assert state_with_solids.num_parts == 1


def test_its_features_are_those_of_the_views_of_the_solids(parts, state_with_solids):
    assert state_with_solids.arrays["features"].shape[:2] == (3, SOLID_VIEWS)
    for row, name in enumerate(("ball", "bar", "plate")):
        views = parts / name / "views"
        part = Example(name, name, parts / name / "part", views, PROCEDURAL.inputs)
        chosen = part.view_indices(8)[:SOLID_VIEWS]
        np.testing.assert_array_equal(chosen, state_with_solids.arrays["views"])
        inputs = load_inputs(PROCEDURAL, part.part, views)
        own_features = hog_features(resize_images(inputs.rgb[chosen], SETTINGS.image_px))
        stored = from_bytes(state_with_solids.arrays["features"][row])
        np.testing.assert_allclose(stored, own_features, atol=0.5 / 255 + 1e-6)


def test_without_solids_it_has_the_parts_alone(parts):
    examples = [
        Example(name, name, parts / name / "part", parts / name / "views", PROCEDURAL.inputs)
        for name in OFFSETS
    ]
    state = PROCEDURAL.fit(examples, SETTINGS, 1, parts)
    assert state.arrays["features"].shape[:2] == (len(OFFSETS), SETTINGS.views)


def test_bytes_are_numbers_to_half_a_step():
    for kind, steps, low in ((np.uint8, 255, 0.0), (np.int8, 254, -0.5)):
        values = np.linspace(low, low + 1, 1001, dtype=np.float32)
        packed = to_bytes(values, kind)
        assert packed.dtype == kind
        np.testing.assert_allclose(from_bytes(packed), values, atol=0.5 / steps + 1e-6)


def test_points_are_thinned_evenly():
    line = np.linspace(0, 1, 1025)[:, None] ** [2, 40, 40] * [1, 0, 0]  # denser towards 0
    kept = np.sort(even_points(line, 65)[:, 0])
    assert np.diff(kept).max() < 2 / 64  # of random ones the largest gap is about 4 / 64


def test_distances_are_summed_view_by_view():
    rng = np.random.default_rng(0)
    part_features = rng.random((4, 3, 5), np.float32)
    query_features = rng.random((3, 5), np.float32)
    expected = [
        sum(
            float(((a.astype(float) - b) ** 2).sum()) ** 0.5
            for a, b in zip(one, query_features, strict=True)
        )
        for one in part_features
    ]
    np.testing.assert_allclose(
        feature_distances(part_features, query_features), expected, rtol=1e-5
    )  # float32


def test_features_tell_edges_and_not_how_bright_a_picture_is():
    rng = np.random.default_rng(0)
    image = rng.integers(0, 100, (1, 32, 32, 3), np.uint8)
    view_features = hog_features(np.concatenate([image, 2 * image, image.swapaxes(1, 2)]))
    # Blocks are normalized, but for an epsilon beside gradients of about 0.1.
    assert np.linalg.norm(view_features[0] - view_features[1]) < 1e-3 * np.linalg.norm(
        view_features[0]
    )
    assert np.linalg.norm(view_features[0] - view_features[2]) > 0.3 * np.linalg.norm(
        view_features[0]
    )
