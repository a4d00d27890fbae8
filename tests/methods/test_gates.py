"""What a network must do before its row means anything: learn parts by heart, and apart.

Far more would be asked of it by other parts; a network that fails here has a fault.  One that is
blind to its pictures fails: of two parts nothing but the pictures tells which is asked for.
"""

from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
import trimesh
from scipy.special import xlogy

from industnerf.artifacts.part import Mesh, load_mesh
from industnerf.artifacts.views import load_views
from industnerf.capture.render import render_part
from industnerf.geometry.isosurface import isosurface_points, volume_matched_level
from industnerf.learning.targets import PADDING, contains_points, surface_points
from industnerf.methods import load_method
from industnerf.methods.atlasnet.chamfer import chamfer
from industnerf.methods.base import Example, load_inputs
from industnerf.metrics.emd import emd
from industnerf.metrics.subsample import farthest_points
from industnerf.schema import AugmentSettings, Params
from tests.methods.conftest import save_as_part

POINTS, DENSE = 512, 8192  # of each cloud that is compared, and that these are chosen from
NO_AUGMENTATION = AugmentSettings(roll_deg=0.0, zoom=0.0, color_jitter=0.0, noise=0.0)


def bracket() -> trimesh.Trimesh:
    """An L."""
    arms = trimesh.creation.box((40, 24, 10)), trimesh.creation.box((10, 24, 30))
    arms[0].apply_translation((0, 0, -10)), arms[1].apply_translation((-15, 0, 10))
    return trimesh.util.concatenate(arms)


def beam() -> trimesh.Trimesh:
    """An I, which fills the bounding box of the bracket."""
    flanges = [trimesh.creation.box((40, 24, 10)) for _ in range(2)]
    flanges[0].apply_translation((0, 0, -10)), flanges[1].apply_translation((0, 0, 20))
    web = trimesh.creation.box((10, 24, 20)).apply_translation((0, 0, 5))
    return trimesh.util.concatenate([*flanges, web])


def ring() -> trimesh.Trimesh:
    """As wide as the bracket."""
    return trimesh.creation.annulus(8.0, 20.0, 14.0, sections=48)


@pytest.fixture(scope="session")
def folders(tmp_path_factory: pytest.TempPathFactory, params: Params) -> dict[str, Path]:
    """One a shape, with `part` and `views`: six photographs of 64 px."""
    folders = {}
    for shape in (bracket, beam, ring):
        folder = folders[shape.__name__] = tmp_path_factory.mktemp(shape.__name__)
        solid = shape()
        mesh = Mesh.with_one_appearance(
            np.array(solid.vertices, float), solid.faces.astype(np.int32)
        )
        save_as_part(folder / "part", mesh)
        views = replace(params.views, count=6, held_out=0, resolution=64, edge_samples=4)
        render_part(folder / "part", folder / "views", views, params.seed)
    return folders


# The rest is as in params.yaml, the size of each network among it.
SETTINGS = {
    "r2n2": ({"max_views": 2}, {"max_steps": 400, "lr": 1e-3, "batch_size": 2}),
    "atlasnet": (
        {"image_px": 32, "train_views": 2, "eval_views": 2},
        {"max_steps": 1200, "lr": 1e-3, "batch_size": 8},
    ),
    "occupancy": (
        {"image_px": 32, "train_views": 2, "eval_views": 2},
        {"max_steps": 400, "lr": 2e-3, "batch_size": 8},
    ),
}


def gate_settings(name: str, params: Params) -> Any:
    whole, training = SETTINGS[name]
    settings = getattr(params.method, name)
    few = replace(settings.training, val_interval=training["max_steps"] // 5, **training)
    few = replace(few, val_fraction=0.5)
    return replace(settings, training=few, augment=NO_AUGMENTATION, points=DENSE, **whole)


def test_nothing_but_the_pictures_tells_a_bracket_from_a_beam(folders):
    bracket, beam = (load_views(folders[name] / "views") for name in ("bracket", "beam"))
    np.testing.assert_array_equal(bracket.cameras.c2w, beam.cameras.c2w)
    np.testing.assert_array_equal(bracket.background, beam.background)
    bracket, beam = (load_mesh(folders[name] / "part") for name in ("bracket", "beam"))
    np.testing.assert_array_equal(
        [bracket.vertices.min(axis=0), bracket.vertices.max(axis=0)],
        [beam.vertices.min(axis=0), beam.vertices.max(axis=0)],
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shapes", "seed"),
    [
        (("bracket",), 0),
        (("bracket", "beam"), 0),
        (("bracket", "beam"), 1),
        (("bracket", "beam"), 2),
        (("bracket", "beam", "ring"), 0),
    ],
    ids=["one", "two-0", "two-1", "two-2", "three"],
)
@pytest.mark.parametrize("name", SETTINGS)
def test_parts_are_learned_by_heart_and_told_apart(name, shapes, seed, folders, params, tmp_path):
    """To 0.01 of what the representation can say, and far better than by any one shape."""
    method, settings = load_method(name), gate_settings(name, params)
    parts = [folders[shape] for shape in shapes]
    examples = [  # all are learned from and all validated on: each is there twice
        Example(f"{group}{i}", group, folder / "part", folder / "views", method.inputs)
        for group in "xy"
        for i, folder in enumerate(parts)
    ]
    state = method.fit(examples, settings, seed, tmp_path)
    if len(parts) > 1:
        best_blind = mean_shape_loss(name, examples[: len(parts)])
        assert state.val_history.loss.min() < 0.75 * best_blind
    truths, first_predictions = [], []
    for example, folder in zip(examples, parts, strict=False):
        inputs = load_inputs(method, folder / "part", folder / "views")
        result = method.reconstruct(inputs, settings, state, seed)
        predictions = [
            farthest_points(inputs.part_frame.to_unit(cloud), POINTS)
            for cloud in (result.points_mm, *result.extra_clouds_mm)
        ]
        truth, other_sample = (
            farthest_points(random_surface(example, sample_seed), POINTS) for sample_seed in (0, 1)
        )
        best = best_prediction(name, example)
        floor = emd(other_sample if best is None else farthest_points(best, POINTS), truth).value
        values = [emd(prediction, truth).value for prediction in predictions]
        assert np.mean(values) < floor + 0.01, (values, floor)
        truths.append(truth)
        first_predictions.append(predictions[0])
    for i, j in combinations(range(len(parts)), 2):
        apart = emd(first_predictions[i], first_predictions[j]).value
        assert apart > 0.8 * emd(truths[i], truths[j]).value


def random_surface(example: Example, seed: int) -> np.ndarray:
    return surface_points(*example.mesh, DENSE, np.random.default_rng(seed)).astype(float)


def best_prediction(name: str, example: Example) -> np.ndarray | None:
    """What it would say if it knew all of its lattice; None: it says points, not a lattice."""
    if name == "atlasnet":
        return None
    values, lo, spacing = lattice_of(name, example)
    rng = np.random.default_rng(0)
    level = volume_matched_level(values)
    return isosurface_points(values, level, np.full(3, lo), spacing, DENSE, rng)


def lattice_of(name: str, example: Example) -> tuple[np.ndarray, float, float]:
    """Whether its cells are full or its points inside, where the first of them is, and spacing."""
    if name == "r2n2":
        return example.filled_shares() / 255, 0.5 / 32 - 0.5, 1 / 32
    lo, spacing = -(1 + PADDING) / 2, (1 + PADDING) / 64
    grid = lo + spacing * np.moveaxis(np.indices((65,) * 3), 0, -1).reshape(-1, 3)
    return contains_points(*example.mesh, grid).reshape((65,) * 3).astype(float), lo, spacing


def mean_shape_loss(name: str, examples: list[Example]) -> float:
    """The least loss of a network that gives one answer whatever it sees, or near to it."""
    if name == "atlasnet":  # one cloud, of whose points each part has its share
        clouds = torch.stack([torch.tensor(random_surface(one, 0)[:2000]) for one in examples])
        count = len(examples)
        return chamfer(clouds[:, ::count].flatten(0, 1).expand(count, -1, -1), clouds).item()
    filled = np.stack([lattice_of(name, example)[0] for example in examples])
    mean = filled.mean(axis=0)
    return float(-(xlogy(filled, mean) + xlogy(1 - filled, 1 - mean)).mean())
