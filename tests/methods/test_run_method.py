"""What stands in a cloud's folder once a method has run on a part."""

import time
from dataclasses import replace

import numpy as np
import pytest

from industnerf.artifacts.candidates import Candidates
from industnerf.artifacts.cloud import Cloud, load_extra_clouds, load_warnings
from industnerf.artifacts.history import History
from industnerf.artifacts.part import load_mesh
from industnerf.artifacts.renderings import Renderings
from industnerf.artifacts.state import ModelState
from industnerf.artifacts.views import ARCHIVE, load_views
from industnerf.errors import ReconstructionFailed, UndeclaredInput
from industnerf.geometry.bounding_cube import BoundingCube
from industnerf.geometry.cameras import nested_view_order
from industnerf.learning.views import picture_frames
from industnerf.methods import load_method
from industnerf.methods.base import Example, Input, Method, Reconstruction, Scope, load_inputs
from industnerf.methods.multi_view_predictions import predictions_to_reconstruction
from industnerf.methods.run_method import fit_method, reconstruct_part, training_files
from industnerf.schema import SampleSettings
from tests.methods.caster import CASTER

SETTINGS = SampleSettings(500)


def run_method(method, rendered_part, target):
    part, views = rendered_part / "part", rendered_part / "views"
    return reconstruct_part(method, part, views, None, target, settings=SETTINGS, seed=0)


def test_all_that_a_method_returns_is_kept(rendered_part, tmp_path):
    run_method(CASTER, rendered_part, tmp_path)
    cloud = Cloud.load(tmp_path)
    n = len(cloud.points_mm)
    assert 400 < n <= 500  # the oracle's: what no camera sees is left out
    np.testing.assert_array_equal(cloud.view, np.arange(n) % 12)
    assert cloud.steps == 6
    assert len(Candidates.load(tmp_path)) == n
    assert History.load(tmp_path).levels == {"first": 0, "second": 3}


def test_what_a_method_remarks_is_kept_and_nothing_if_it_is_silent(rendered_part, tmp_path):
    def warning_caster(inputs, settings, state, seed):
        result = CASTER.reconstruct(inputs, settings, state, seed)
        return replace(result, warnings=("it glints",))

    for name, method in (("a", CASTER), ("b", replace(CASTER, reconstruct=warning_caster))):
        (tmp_path / name).mkdir()
        run_method(method, rendered_part, tmp_path / name)
    assert load_warnings(tmp_path / "a") == []
    assert load_warnings(tmp_path / "b") == ["it glints"]


def test_the_held_out_cameras_are_those_of_the_held_out_photographs(rendered_part, tmp_path):
    """Rays cast from what the method was handed meet the part where the photographs show it."""
    run_method(CASTER, rendered_part, tmp_path)
    renderings, loaded_views = Renderings.load(tmp_path), load_views(rendered_part / "views")
    held_out = np.flatnonzero(loaded_views.held_out)
    np.testing.assert_array_equal(renderings.foreground, loaded_views.mask(held_out))
    # both are rounded to a step of 16 bits, and cast in float32, 1e-6 of the size
    step = loaded_views.depth_scale_mm + renderings.depth_mm.max() / 65535
    np.testing.assert_allclose(
        renderings.depth_mm, loaded_views.depth_mm(held_out), rtol=0, atol=step
    )


def slow_caster(inputs, settings, state, seed):
    """The caster, whose pictures take half a second."""
    result = CASTER.reconstruct(inputs, settings, state, seed)

    def render():
        time.sleep(0.5)
        return result.render()

    return replace(result, render=render)


def test_the_seconds_that_pictures_take_are_told(rendered_part, tmp_path):
    slow = replace(CASTER, reconstruct=slow_caster)
    assert run_method(slow, rendered_part, tmp_path).wall >= 0.5
    assert run_method(load_method("oracle"), rendered_part, tmp_path).wall < 0.5


def test_a_method_that_returns_points_alone_leaves_a_cloud_alone(rendered_part, tmp_path):
    run_method(load_method("oracle"), rendered_part, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cloud.npz", "cloud.ply"]
    assert (Cloud.load(tmp_path).view == -1).all()


INPUTS = frozenset({Input.PART_FRAME, Input.OTHER_MESHES})


def fit(examples, settings, seed, scratch):
    """Keeps the first example's corners; leaves a note in `scratch`."""
    (scratch / "note").write_text("half done")
    return ModelState({"corners": examples[0].mesh[0]}, num_parts=len(examples), steps=7)


def recall_training(inputs, settings, state, seed):
    corners = state.arrays["corners"]
    return predictions_to_reconstruction(
        [np.zeros((0, 3)), corners, corners[:2]], inputs.part_frame, state
    )


LEARNER = Method("learner", Scope.DATASET, INPUTS, recall_training, fit)


@pytest.fixture
def fitted_state(rendered_part, tmp_path):
    """The folder of what LEARNER has learned of the photographed part."""
    example = Example("p", "p", rendered_part / "part", rendered_part / "views", INPUTS)
    state = tmp_path / "state"
    state.mkdir()
    fit_method(LEARNER, [example], state, settings=SETTINGS, seed=0, scratch=tmp_path)
    return state


def test_what_is_learned_reaches_the_reconstruction(rendered_part, fitted_state, tmp_path):
    part, views = rendered_part / "part", rendered_part / "views"
    reconstruct_part(LEARNER, part, views, fitted_state, tmp_path, settings=SETTINGS, seed=0)
    cloud, corners = Cloud.load(tmp_path), load_mesh(part).vertices
    assert cloud.steps == 7
    # float32 at 300 mm is exact to 3e-5
    np.testing.assert_allclose(cloud.points_mm, corners, rtol=0, atol=1e-4)
    others = load_extra_clouds(tmp_path)
    assert [len(points) for points in others] == [2, 0]  # an empty answer stays one
    np.testing.assert_allclose(others[0], corners[:2], rtol=0, atol=1e-4)


def test_nothing_to_learn_from_names_the_knob(tmp_path):
    with pytest.raises(ReconstructionFailed, match=r"split\.hold_out"):
        fit_method(LEARNER, [], tmp_path, settings=SETTINGS, seed=0, scratch=tmp_path)


def test_an_example_gives_only_what_is_declared(rendered_part):
    part, views = rendered_part / "part", rendered_part / "views"
    with pytest.raises(UndeclaredInput, match="'rgb'"):
        Example("p", "p", part, views, INPUTS).rgb(32, 4)
    with pytest.raises(UndeclaredInput, match="'other meshes'"):
        _ = Example("p", "p", part, views, frozenset({Input.RGB})).mesh


def test_an_example_is_the_training_views_and_the_part_in_the_unit_cube(rendered_part):
    part, views = rendered_part / "part", rendered_part / "views"
    example = Example("p", "p", part, views, frozenset({Input.RGB, Input.OTHER_MESHES}))
    assert example.rgb(32, 4).shape == (4, 32, 32, 3)
    assert example.rgb(32, 99).shape == (12, 32, 32, 3)  # none of the two held out
    vertices, _ = example.mesh
    assert np.ptp(vertices, axis=0).max() == pytest.approx(1)
    np.testing.assert_allclose(vertices.max(axis=0), -vertices.min(axis=0))


def test_an_examples_pictures_backgrounds_and_axes_are_of_the_same_views(rendered_part):
    """Of the first in nested order, which look from all round."""
    part, views = rendered_part / "part", rendered_part / "views"
    inputs = frozenset({Input.RGB, Input.BACKGROUND, Input.OTHER_MESHES})
    example, loaded = Example("p", "p", part, views, inputs), load_views(views)
    order = loaded.train_indices[nested_view_order(loaded.cameras[loaded.train_indices].centers, 5)]
    np.testing.assert_array_equal(example.rgb(64, 5), loaded.rgb(order))
    np.testing.assert_array_equal(example.background(5), loaded.background[order])
    frames = picture_frames(loaded.cameras[order], BoundingCube.of(load_mesh(part).vertices))
    np.testing.assert_array_equal(example.picture_frames(5), frames)
    assert sorted(order) != order.tolist()


def test_a_net_depends_on_what_is_declared_of_its_parts(rendered_part):
    part, views = rendered_part / "part", rendered_part / "views"
    mesh = part / "mesh.npz"
    assert training_files(Example("p", "p", part, views, INPUTS)) == (mesh,)
    with_rgb = Example("p", "p", part, views, INPUTS | {Input.RGB})
    assert training_files(with_rgb) == (
        views / ARCHIVE / "cameras.json",
        views / ARCHIVE / "rgb",
        mesh,
    )


def first_pixel_view(inputs, settings, state, seed):
    """Three points: of the first view handed over, of the last, and of none."""
    view = np.array([0, len(inputs.rgb) - 1, -1])
    return Reconstruction(np.eye(3), view=view)


def test_few_of_the_views_are_those_with_their_own_cameras_and_numbers(rendered_part, tmp_path):
    part, views = rendered_part / "part", rendered_part / "views"
    method = Method(
        "witness", Scope.PART, frozenset({Input.RGB, Input.BACKGROUND}), first_pixel_view
    )
    all_views, few = (load_inputs(method, part, views, count) for count in (0, 5))
    assert len(all_views.rgb) == 12
    assert all_views.view_indices is None
    np.testing.assert_array_equal(few.rgb, all_views.rgb[few.view_indices])
    np.testing.assert_array_equal(few.cameras.c2w, all_views.cameras.c2w[few.view_indices])
    np.testing.assert_array_equal(few.held_out.c2w, all_views.held_out.c2w)
    assert len(few.background) == 5
    reconstruct_part(method, part, views, None, tmp_path, settings=None, seed=0, num_views=5)
    assert Cloud.load(tmp_path).view.tolist() == [few.view_indices[0], few.view_indices[-1], -1]
    assert few.view_indices[-1] > 4
