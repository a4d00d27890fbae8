"""The mean of known shapes, and the level it is cut at against all others."""

from pathlib import Path
from unittest.mock import create_autospec

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from industnerf.artifacts.part import Mesh
from industnerf.geometry.bounding_cube import BoundingCube
from industnerf.learning.procedural_shapes import ProceduralArrays, ProceduralShape
from industnerf.learning.training_shape import Prior
from industnerf.methods import load_method, mean_shape
from industnerf.methods.base import Example, Input, MethodInputs, Role
from industnerf.methods.mean_shape import (
    MAX_COMPARED,
    MAX_LEVELS,
    best_level,
    candidate_levels,
    chamfer,
    level_set_points,
)
from industnerf.schema import MeanShapeSettings, SampleSettings
from tests.methods.conftest import save_as_part
from tests.methods.solids import cameras_around

MEAN_SHAPE = load_method("mean_shape")
PROCEDURAL = load_method("mean_shape_procedural")
SIZE = np.array([1.0, 0.6, 0.4])


def example(folder: Path, scale: float, shift: tuple[float, float, float]) -> Example:
    """A box of `SIZE` times `scale`, shifted."""
    box = trimesh.creation.box(scale * SIZE)
    mesh = Mesh.with_one_appearance(
        np.array(box.vertices, float) + shift, box.faces.astype(np.int32)
    )
    save_as_part(folder, mesh)
    return Example(folder.name, folder.name, folder, folder, MEAN_SHAPE.inputs)


def test_the_mean_of_equal_shapes_is_that_shape_at_the_place_of_the_part(tmp_path):
    offsets = [(1.0, (0.0, 0.0, 0.0)), (30.0, (7.0, 8.0, 9.0)), (0.2, (-5.0, 0.0, 1.0))]
    examples = [example(tmp_path / str(i), *offset) for i, offset in enumerate(offsets)]
    settings = MeanShapeSettings(grid_res=32, points=4000)
    state = MEAN_SHAPE.fit(examples, settings, 3, tmp_path)
    cameras, center, edge = cameras_around(2, 8, 50.0), np.array([50.0, -60.0, 70.0]), 20.0
    inputs = MethodInputs(
        "mean_shape", cameras, cameras, {Input.PART_FRAME: BoundingCube(center, edge)}
    )
    points = MEAN_SHAPE.reconstruct(inputs, settings, state, 4).points_mm
    beyond = (np.abs(points - center) / edge - SIZE / 2).max(axis=1)
    # A voxel is 1/32: those that the surface passes through are full, and the surface that is
    # found is half a voxel round the centers of the full ones.
    assert np.abs(beyond).max() < 1 / 32
    assert state.num_parts == 3


def solid_of(part: Example) -> ProceduralShape:
    """What the stage `procedural` stores of the shape of a solid, of a part."""
    surface = part.surface_pool(np.random.default_rng(5)).astype(np.float16)[None]
    arrays = ProceduralArrays(
        np.zeros((1, 1, 8, 8, 3), np.uint8),
        np.zeros((1, 1, 3), np.float32),
        np.zeros((1, 1, 3, 3), np.float32),
        part.filled_shares()[None],
        np.zeros((1, 8, 3), np.float16),
        np.zeros((1, 3), np.float32),
        surface,
    )
    return ProceduralShape("solid", "solid", "box", None, arrays, 0)


def test_the_mean_of_parts_and_thousands_of_solids_costs_few_comparisons(tmp_path, monkeypatch):
    """A ball among very many boxes: the box."""
    box = example(tmp_path / "box", 3.0, (1.0, 2.0, 3.0))
    mesh = trimesh.creation.icosphere(2, 0.5)
    vertices, faces = np.array(mesh.vertices, float), mesh.faces.astype(np.int32)
    save_as_part(tmp_path / "ball", Mesh.with_one_appearance(vertices, faces))
    ball_part = Example("ball", "ball", tmp_path / "ball", tmp_path / "ball", MEAN_SHAPE.inputs)
    spy = create_autospec(chamfer, side_effect=chamfer)
    monkeypatch.setattr(mean_shape, "chamfer", spy)
    solids = [solid_of(box)] * 2000
    state = PROCEDURAL.fit([ball_part], SampleSettings(4000), 3, tmp_path, Prior(solids))
    mean, level = state.arrays["mean"], float(state.arrays["level"])
    points = level_set_points(mean, level, 4000, np.random.default_rng(0))
    assert np.abs((np.abs(points) - SIZE / 2).max(axis=1)).max() < 1 / 32
    assert mean.shape == (32, 32, 32)
    assert mean[1, 16, 16] == pytest.approx(1, abs=1e-6)  # in all of them
    assert mean[16, 1, 16] == pytest.approx(1 / 2001, abs=1e-6)  # in the ball alone
    assert state.num_parts == 1
    assert spy.call_count <= MAX_LEVELS * MAX_COMPARED


def test_of_too_many_levels_some_of_every_rank_are_tried():
    mean = np.random.default_rng(0).random((16, 16, 16)) ** 4
    levels = candidate_levels(mean)
    assert len(levels) == MAX_LEVELS
    shares_below = (mean.reshape(-1, 1) < levels).mean(axis=0)
    np.testing.assert_allclose(shares_below, np.linspace(0, 1, MAX_LEVELS), atol=1 / 16**3)


def ball(radius: float) -> np.ndarray:
    """Whether each of 48^3 voxels of the unit cube has its center in a ball."""
    axis = (np.arange(48) + 0.5) / 48 - 0.5
    return np.linalg.norm(np.stack(np.meshgrid(axis, axis, axis)), axis=0) < radius


def sphere(radius: float, count: int = 2000) -> np.ndarray:
    """Points that are uniform on a sphere."""
    points = np.random.default_rng(0).normal(size=(count, 3))
    return radius * points / np.linalg.norm(points, axis=1, keepdims=True)


@pytest.mark.parametrize(("radii", "wanted"), [((0.1, 0.3, 0.45), 0.3), ((0.2, 0.2, 0.4), 0.2)])
def test_of_balls_the_one_in_the_middle_is_cut(radii, wanted):
    """To spheres of one center the sum of |r - r_i| is least at the median of the radii."""
    mean = np.mean([ball(radius) for radius in radii], axis=0)
    rng = np.random.default_rng(0)
    points = level_set_points(
        mean, best_level(mean, [sphere(radius) for radius in radii], rng), 2000, rng
    )
    # Voxels are 1/48 wide, and the surface lies between two centers.
    assert np.linalg.norm(points, axis=1).mean() == pytest.approx(wanted, abs=1 / 48)


def test_of_slender_parts_that_lie_otherwise_more_than_what_is_common_is_kept():
    """Two rods that cross: both of them, not the speck where they meet."""
    solids = np.zeros((2, 48, 48, 48), bool)
    for axis, solid in enumerate(solids):
        np.moveaxis(solid, axis, 0)[:, 20:28, 20:28] = True
    centers = [(np.argwhere(solid) + 0.5) / 48 - 0.5 for solid in solids]
    mean, rng = solids.mean(axis=0), np.random.default_rng(0)
    shape = level_set_points(mean, best_level(mean, centers, rng), 500, rng)
    assert (np.ptp(shape, axis=0)[:2] > 0.9).all()


def test_chamfer_distance_of_two_small_clouds():
    a, b = np.array([[0.0, 0, 0], [1, 0, 0]]), np.array([[0.0, 0, 2]])
    assert chamfer(cKDTree(a), cKDTree(b)) == pytest.approx(2 + (2 + 5**0.5) / 2)


@pytest.mark.parametrize("count", [1, 3])
def test_of_equal_solids_the_level_lies_between_empty_and_full(count):
    mean = np.mean([ball(0.3)] * count, axis=0)
    assert best_level(mean, [sphere(0.3)] * count, np.random.default_rng(0)) == 0.5


def test_it_is_declared_as_a_null():
    assert MEAN_SHAPE.role is Role.NULL
