"""The mean of known shapes, and the level it is cut at against all others."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.part import Mesh
from industnerf.geometry.boxes import Cube
from industnerf.methods import load_method
from industnerf.methods.base import Example, Given, Input, Role
from industnerf.methods.mean_shape import best_level, mean_iou
from industnerf.schema import MeanShapeSettings
from tests.methods.conftest import save_as_part
from tests.methods.solids import cameras_around

MEAN_SHAPE = load_method("mean_shape")
SIZE = np.array([1.0, 0.6, 0.4])


def example(folder: Path, scale: float, shift: tuple[float, float, float]) -> Example:
    """A box of `SIZE` times `scale`, shifted."""
    box = trimesh.creation.box(scale * SIZE)
    mesh = Mesh.plain(np.array(box.vertices, float) + shift, box.faces.astype(np.int32))
    save_as_part(folder, mesh)
    return Example(folder.name, folder, folder, MEAN_SHAPE.inputs)


def test_the_mean_of_equal_shapes_is_that_shape_at_the_place_of_the_part(tmp_path):
    places = [(1.0, (0.0, 0.0, 0.0)), (30.0, (7.0, 8.0, 9.0)), (0.2, (-5.0, 0.0, 1.0))]
    examples = [example(tmp_path / str(i), *place) for i, place in enumerate(places)]
    settings = MeanShapeSettings(grid_res=32, points=4000)
    state = MEAN_SHAPE.fit(examples, settings, 3, tmp_path)
    cameras, centre, edge = cameras_around(2, 8, 50.0), np.array([50.0, -60.0, 70.0]), 20.0
    given = Given("mean_shape", cameras, cameras, {Input.FRAME: Cube(centre, edge)})
    points = MEAN_SHAPE.reconstruct(given, settings, state, 4).points_mm
    beyond = (np.abs(points - centre) / edge - SIZE / 2).max(axis=1)
    # A voxel is 1/32: those that the surface passes through are full, and the surface that is
    # found is half a voxel round the centres of the full ones.
    assert np.abs(beyond).max() < 1 / 32
    assert state.parts == 3


@pytest.mark.parametrize("seed", range(5))
def test_no_level_has_a_better_iou(seed):
    rng = np.random.default_rng(seed)
    likely = rng.random((6, 6, 6))
    solids = rng.random((5, 6, 6, 6)) < likely
    mean = solids.mean(axis=0)
    best = mean_iou(mean > best_level(mean, solids), solids)
    assert best == max(mean_iou(mean > level, solids) for level in np.linspace(0, 0.999, 200))


def test_iou_is_counted_voxel_by_voxel():
    rng = np.random.default_rng(0)
    shape, solids = rng.random((3, 3, 3)) < 0.5, rng.random((4, 3, 3, 3)) < 0.5
    ious = []
    for solid in solids:
        pairs = list(zip(shape.ravel(), solid.ravel(), strict=True))
        ious.append(sum(a and b for a, b in pairs) / sum(a or b for a, b in pairs))
    assert mean_iou(shape, solids) == pytest.approx(np.mean(ious), rel=1e-12)


@pytest.mark.parametrize("count", [1, 3])
def test_of_equal_solids_the_level_lies_between_empty_and_full(count):
    solid = np.zeros((4, 4, 4), bool)
    solid[1:3, 1:3, 1:3] = True
    solids = np.stack([solid] * count)
    assert best_level(solids.mean(axis=0), solids) == 0.5


def test_it_is_declared_as_a_null():
    assert MEAN_SHAPE.role is Role.NULL
