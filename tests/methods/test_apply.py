"""What stands in a cloud's folder once a method has run on a part."""

import time
from dataclasses import replace

import numpy as np
import pytest

from industnerf.artifacts.candidates import Candidates
from industnerf.artifacts.cloud import Cloud, load_others, load_remarks
from industnerf.artifacts.history import History
from industnerf.artifacts.part import load_mesh
from industnerf.artifacts.renderings import Renderings
from industnerf.artifacts.state import State
from industnerf.artifacts.views import load_views
from industnerf.errors import ReconstructionFailed, UndeclaredInput
from industnerf.methods import load_method
from industnerf.methods.answers import answered
from industnerf.methods.apply import files_to_learn_from, learn, reconstruct_part
from industnerf.methods.base import Example, Input, Method, Reconstruction, Scope, hand_over
from industnerf.schema import SampleSettings
from tests.methods.caster import CASTER

SETTINGS = SampleSettings(500)


def run(method, photographed, target):
    part, views = photographed / "part", photographed / "views"
    return reconstruct_part(method, part, views, None, target, settings=SETTINGS, seed=0)


def test_all_that_a_method_returns_is_kept(photographed, tmp_path):
    run(CASTER, photographed, tmp_path)
    cloud = Cloud.load(tmp_path)
    np.testing.assert_array_equal(cloud.view, np.arange(500) % 12)
    assert cloud.steps == 6
    assert len(Candidates.load(tmp_path)) == 500
    assert History.load(tmp_path).levels == {"first": 0, "second": 3}


def test_what_a_method_remarks_is_kept_and_nothing_if_it_is_silent(photographed, tmp_path):
    def remarking(given, settings, state, seed):
        found = CASTER.reconstruct(given, settings, state, seed)
        return replace(found, remarks=("it glints",))

    for name, method in (("a", CASTER), ("b", replace(CASTER, reconstruct=remarking))):
        (tmp_path / name).mkdir()
        run(method, photographed, tmp_path / name)
    assert load_remarks(tmp_path / "a") == []
    assert load_remarks(tmp_path / "b") == ["it glints"]


def test_the_held_out_cameras_are_those_of_the_held_out_photographs(photographed, tmp_path):
    """Rays cast from what the method was handed meet the part where the photographs show it."""
    run(CASTER, photographed, tmp_path)
    seen, taken = Renderings.load(tmp_path), load_views(photographed / "views")
    held_out = np.flatnonzero(taken.held_out)
    np.testing.assert_array_equal(seen.foreground, taken.mask(held_out))
    # both are rounded to a step of 16 bits, and cast in float32, 1e-6 of the size
    step = taken.depth_scale_mm + seen.depth_mm.max() / 65535
    np.testing.assert_allclose(seen.depth_mm, taken.depth_mm(held_out), rtol=0, atol=step)


def slow_caster(given, settings, state, seed):
    """The caster, whose pictures take half a second."""
    found = CASTER.reconstruct(given, settings, state, seed)

    def render():
        time.sleep(0.5)
        return found.render()

    return replace(found, render=render)


def test_the_seconds_that_pictures_take_are_told(photographed, tmp_path):
    assert run(replace(CASTER, reconstruct=slow_caster), photographed, tmp_path) >= 0.5
    assert run(load_method("oracle"), photographed, tmp_path) < 0.5


def test_a_method_that_returns_points_alone_leaves_a_cloud_alone(photographed, tmp_path):
    run(load_method("oracle"), photographed, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cloud.npz", "cloud.ply"]
    assert (Cloud.load(tmp_path).view == -1).all()


INPUTS = frozenset({Input.FRAME, Input.OTHER_MESHES})


def fit(examples, settings, seed, scratch):
    """Keeps the first example's corners; leaves a note in `scratch`."""
    (scratch / "note").write_text("half done")
    return State({"corners": examples[0].mesh[0]}, parts=len(examples), steps=7)


def remember(given, settings, state, seed):
    corners = state.arrays["corners"]
    return answered([np.zeros((0, 3)), corners, corners[:2]], given.frame, state)


LEARNER = Method("learner", Scope.DATASET, INPUTS, remember, fit)


@pytest.fixture
def learned(photographed, tmp_path):
    """The folder of what LEARNER has learned of the photographed part."""
    example = Example("p", photographed / "part", photographed / "views", INPUTS)
    state = tmp_path / "state"
    state.mkdir()
    learn(LEARNER, [example], state, settings=SETTINGS, seed=0, scratch=tmp_path)
    return state


def test_what_is_learned_reaches_the_reconstruction(photographed, learned, tmp_path):
    part, views = photographed / "part", photographed / "views"
    reconstruct_part(LEARNER, part, views, learned, tmp_path, settings=SETTINGS, seed=0)
    cloud, corners = Cloud.load(tmp_path), load_mesh(part).vertices
    assert cloud.steps == 7
    # float32 at 300 mm is exact to 3e-5
    np.testing.assert_allclose(cloud.points_mm, corners, rtol=0, atol=1e-4)
    others = load_others(tmp_path)
    assert [len(points) for points in others] == [2, 0]  # an empty answer stays one
    np.testing.assert_allclose(others[0], corners[:2], rtol=0, atol=1e-4)


def test_nothing_to_learn_from_names_the_knob(tmp_path):
    with pytest.raises(ReconstructionFailed, match=r"split\.hold_out"):
        learn(LEARNER, [], tmp_path, settings=SETTINGS, seed=0, scratch=tmp_path)


def test_an_example_gives_only_what_is_declared(photographed):
    part, views = photographed / "part", photographed / "views"
    with pytest.raises(UndeclaredInput, match="'rgb'"):
        Example("p", part, views, INPUTS).rgb(32, 4)
    with pytest.raises(UndeclaredInput, match="'other meshes'"):
        _ = Example("p", part, views, frozenset({Input.RGB})).mesh


def test_an_example_is_the_training_views_and_the_part_in_the_unit_cube(photographed):
    part, views = photographed / "part", photographed / "views"
    example = Example("p", part, views, frozenset({Input.RGB, Input.OTHER_MESHES}))
    assert example.rgb(32, 4).shape == (4, 32, 32, 3)
    assert example.rgb(32, 99).shape == (12, 32, 32, 3)  # none of the two held out
    vertices, _ = example.mesh
    assert np.ptp(vertices, axis=0).max() == pytest.approx(1)
    np.testing.assert_allclose(vertices.max(axis=0), -vertices.min(axis=0))


def test_a_net_depends_on_what_is_declared_of_its_parts(photographed):
    part, views = photographed / "part", photographed / "views"
    mesh = part / "mesh.npz"
    assert files_to_learn_from(Example("p", part, views, INPUTS)) == (mesh,)
    with_rgb = Example("p", part, views, INPUTS | {Input.RGB})
    assert files_to_learn_from(with_rgb) == (views / "cameras.json", views / "rgb", mesh)


def witness(given, settings, state, seed):
    """Three points: of the first view handed over, of the last, and of none."""
    view = np.array([0, len(given.rgb) - 1, -1])
    return Reconstruction(np.eye(3), view=view)


def test_few_of_the_views_are_those_with_their_own_cameras_and_numbers(photographed, tmp_path):
    part, views = photographed / "part", photographed / "views"
    method = Method("witness", Scope.PART, frozenset({Input.RGB, Input.BACKGROUND}), witness)
    every, few = (hand_over(method, part, views, count) for count in (0, 5))
    assert len(every.rgb) == 12
    assert every.chosen is None
    np.testing.assert_array_equal(few.rgb, every.rgb[few.chosen])
    np.testing.assert_array_equal(few.cameras.c2w, every.cameras.c2w[few.chosen])
    np.testing.assert_array_equal(few.held_out.c2w, every.held_out.c2w)
    assert len(few.background) == 5
    reconstruct_part(method, part, views, None, tmp_path, settings=None, seed=0, count=5)
    assert Cloud.load(tmp_path).view.tolist() == [few.chosen[0], few.chosen[-1], -1]
    assert few.chosen[-1] > 4
