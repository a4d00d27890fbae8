"""The methods as the suite calls them: what they are given, and what they give."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from industnerf.artifacts.views import ARCHIVE, load_views
from industnerf.methods import load_method
from industnerf.methods.base import Input, Reconstruction, load_inputs
from tests.archives import opened
from tests.methods.industnerf.synthetic_scenes import settings

NAMES = ("industnerf", "industnerf_plus", "industnerf_depth", "nerf")
every_name = pytest.mark.parametrize("name", NAMES)
QUICK = {"grid_res": 16, "rays_per_step": 512, "surface_spacing": 0.05, "min_confidence": 0.02}


def reconstruct(name: str, folder: Path, cloud: str = "confident_points") -> Reconstruction:
    inputs = load_inputs(load_method(name), folder / "part", folder / "views")
    level = {"steps": 30, "image_px": 64}
    config = settings(name, **QUICK, levels=[level], readings={"extraction": cloud})
    return load_method(name).reconstruct(inputs, config, None, 1)


@every_name
def test_only_what_is_declared_is_handed_over(name, rendered_part):
    inputs = load_inputs(load_method(name), rendered_part / "part", rendered_part / "views")
    extra_inputs = {"industnerf_plus": {Input.BACKGROUND}, "industnerf_depth": {Input.DEPTH}}
    assert set(inputs.loaded) == {Input.RGB} | extra_inputs.get(name, set())


def with_background(source: Path, target: Path, color: list[float]) -> Path:
    """The same photographs, and another color said to be behind the part."""
    shutil.copytree(source, target)
    with opened(target / "views" / ARCHIVE) as folder:
        content = json.loads((folder / "cameras.json").read_text())
        for camera in content["cameras"]:
            camera["background"] = color
        (folder / "cameras.json").write_text(json.dumps(content))
    assert (load_views(target / "views").background == color).all()
    return target


@pytest.mark.parametrize("name", ["industnerf", "nerf"])
def test_who_is_not_told_of_the_background_does_not_know_it(name, rendered_part, tmp_path):
    wrong_background = with_background(rendered_part, tmp_path / "gray", [0.5, 0.5, 0.5])
    correct, wrong = (reconstruct(name, folder) for folder in (rendered_part, wrong_background))
    assert correct.points_mm.tobytes() == wrong.points_mm.tobytes()
    np.testing.assert_array_equal(correct.render().rgb, wrong.render().rgb)


def test_the_other_one_does(rendered_part, tmp_path):
    wrong_background = with_background(rendered_part, tmp_path / "gray", [0.5, 0.5, 0.5])
    correct, wrong = (
        reconstruct("industnerf_plus", folder) for folder in (rendered_part, wrong_background)
    )
    assert correct.points_mm.tobytes() != wrong.points_mm.tobytes()


@pytest.mark.slow
def test_with_readings_nowhere_depth_is_the_papers_method_and_with_some_another(rendered_part):
    name = "industnerf_depth"
    inputs = load_inputs(load_method(name), rendered_part / "part", rendered_part / "views")
    no_depth = {**inputs.loaded, Input.DEPTH: np.zeros_like(inputs.depth_mm)}
    config = settings(name, **QUICK, levels=[{"steps": 30, "image_px": 64}])
    with_depth, without_depth, rgb_only = (
        load_method(method).reconstruct(method_inputs, config, None, 1)
        for method, method_inputs in (
            (name, inputs),
            (name, replace(inputs, loaded=no_depth)),
            ("industnerf", replace(inputs, loaded={Input.RGB: inputs.rgb})),
        )
    )
    assert without_depth.points_mm.tobytes() == rgb_only.points_mm.tobytes()
    assert with_depth.points_mm.tobytes() != rgb_only.points_mm.tobytes()


@every_name
def test_what_is_returned_fits_together(name, rendered_part):
    result = reconstruct(name, rendered_part)
    n = len(result.points_mm)
    assert n > 0
    assert len(result.colors) == len(result.confidence) == len(result.view) == n
    assert ((result.view >= 0) & (result.view < 12)).all()
    assert ((result.confidence >= 0.02) & (result.confidence <= 1)).all()
    assert result.steps == len(result.history.loss) == 30
    assert result.history.levels == {"level 0": 0}
    assert result.num_parameters > 0
    assert len(result.candidates) > 0
    assert result.render().rgb.shape == (2, 64, 64, 3)


@every_name
def test_held_out_views_are_rendered_before_the_background(name, rendered_part):
    rendering = reconstruct(name, rendered_part).render()
    empty = rendering.opacity == 0
    assert empty[:, [0, 0, -1, -1], [0, -1, 0, -1]].all()  # no point is ever that far out
    assert (rendering.rgb[empty] == 255).all()


@every_name
@pytest.mark.parametrize("cloud", ["confident_points", "surface_points"])
def test_confident_points_are_of_the_candidates(name, cloud, rendered_part):
    """They are some of all that have a density, but for a few that stand beside such a point and
    are sure through it; surface points lie between the cloud's points."""
    result = reconstruct(name, rendered_part, cloud)
    candidates = {tuple(point) for point in result.candidates.points_mm.tolist()}
    same = [tuple(p) in candidates for p in result.points_mm.astype(np.float32).tolist()]
    # a tent is made sure at all eight corners of a cell, of which some stand beside matter
    min_share = {"nerf": 0.5, "industnerf_plus": 0.5, "industnerf_depth": 0.9}.get(name, 0.95)
    assert np.mean(same) > min_share if cloud == "confident_points" else not any(same)
