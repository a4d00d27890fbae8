"""What stands in a cloud's folder once a method has run on a part."""

import numpy as np

from industnerf.artifacts.candidates import Candidates
from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.history import History
from industnerf.artifacts.renderings import Renderings
from industnerf.artifacts.views import load_views
from industnerf.methods import load_method
from industnerf.methods.apply import reconstruct_part
from industnerf.schema import SampleSettings
from tests.methods.caster import CASTER

SETTINGS = SampleSettings(500)


def run(method, photographed, target):
    places = (photographed / "part", photographed / "views", target)
    reconstruct_part(method, *places, settings=SETTINGS, seed=0)


def test_all_that_a_method_returns_is_kept(photographed, tmp_path):
    run(CASTER, photographed, tmp_path)
    cloud = Cloud.load(tmp_path)
    np.testing.assert_array_equal(cloud.view, np.arange(500) % 12)
    assert cloud.steps == 6
    assert len(Candidates.load(tmp_path)) == 500
    assert History.load(tmp_path).levels == {"first": 0, "second": 3}


def test_the_held_out_cameras_are_those_of_the_held_out_photographs(photographed, tmp_path):
    """Rays cast from what the method was handed meet the part where the photographs show it."""
    run(CASTER, photographed, tmp_path)
    seen, taken = Renderings.load(tmp_path), load_views(photographed / "views")
    held_out = np.flatnonzero(taken.held_out)
    np.testing.assert_array_equal(seen.foreground, taken.mask(held_out))
    # both are rounded to a step of 16 bits, and cast in float32, 1e-6 of the size
    step = taken.depth_scale_mm + seen.depth_mm.max() / 65535
    np.testing.assert_allclose(seen.depth_mm, taken.depth_mm(held_out), rtol=0, atol=step)


def test_a_method_that_returns_points_alone_leaves_a_cloud_alone(photographed, tmp_path):
    run(load_method("oracle"), photographed, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cloud.npz", "cloud.ply"]
    assert (Cloud.load(tmp_path).view == -1).all()
