"""The methods as the suite calls them: what they are given, and what they give."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from industnerf.artifacts.views import load_views
from industnerf.methods import load_method
from industnerf.methods.base import Input, Reconstruction, hand_over
from tests.methods.industnerf.scenes import settings

NAMES = ("industnerf", "industnerf_plus", "industnerf_depth", "nerf")
every_name = pytest.mark.parametrize("name", NAMES)
QUICK = {"grid_res": 16, "rays": 512, "spacing": 0.05, "least_confidence": 0.02}


def reconstructed(name: str, folder: Path, cloud: str = "confident") -> Reconstruction:
    given = hand_over(load_method(name), folder / "part", folder / "views")
    level = {"steps": 30, "image_px": 64}
    ways = settings(name, **QUICK, levels=[level], readings={"cloud": cloud})
    return load_method(name).reconstruct(given, ways, None, 1)


@every_name
def test_only_what_is_declared_is_handed_over(name, photographed):
    given = hand_over(load_method(name), photographed / "part", photographed / "views")
    more = {"industnerf_plus": {Input.BACKGROUND}, "industnerf_depth": {Input.DEPTH}}
    assert set(given.handed) == {Input.RGB} | more.get(name, set())


def with_background(source: Path, target: Path, colour: list[float]) -> Path:
    """The same photographs, and another colour said to be behind the part."""
    shutil.copytree(source, target)
    path = target / "views" / "cameras.json"
    content = json.loads(path.read_text())
    for camera in content["cameras"]:
        camera["background"] = colour
    path.write_text(json.dumps(content))
    assert (load_views(target / "views").background == colour).all()
    return target


@pytest.mark.parametrize("name", ["industnerf", "nerf"])
def test_who_is_not_told_of_the_background_does_not_know_it(name, photographed, tmp_path):
    told_lies = with_background(photographed, tmp_path / "grey", [0.5, 0.5, 0.5])
    here, there = (reconstructed(name, folder) for folder in (photographed, told_lies))
    assert here.points_mm.tobytes() == there.points_mm.tobytes()
    np.testing.assert_array_equal(here.render().rgb, there.render().rgb)


def test_the_other_one_does(photographed, tmp_path):
    told_lies = with_background(photographed, tmp_path / "grey", [0.5, 0.5, 0.5])
    here, there = (reconstructed("industnerf_plus", folder) for folder in (photographed, told_lies))
    assert here.points_mm.tobytes() != there.points_mm.tobytes()


def test_with_readings_nowhere_depth_is_the_papers_method_and_with_some_another(photographed):
    name = "industnerf_depth"
    given = hand_over(load_method(name), photographed / "part", photographed / "views")
    blind = {**given.handed, Input.DEPTH: np.zeros_like(given.depth_mm)}
    ways = settings(name, **QUICK, levels=[{"steps": 30, "image_px": 64}])
    told, untold, plain = (
        load_method(method).reconstruct(shown, ways, None, 1)
        for method, shown in (
            (name, given),
            (name, replace(given, handed=blind)),
            ("industnerf", replace(given, handed={Input.RGB: given.rgb})),
        )
    )
    assert untold.points_mm.tobytes() == plain.points_mm.tobytes()
    assert told.points_mm.tobytes() != plain.points_mm.tobytes()


@every_name
def test_what_is_returned_fits_together(name, photographed):
    result = reconstructed(name, photographed)
    n = len(result.points_mm)
    assert n > 0
    assert len(result.colours) == len(result.confidence) == len(result.view) == n
    assert ((result.view >= 0) & (result.view < 12)).all()
    assert ((result.confidence >= 0.02) & (result.confidence <= 1)).all()
    assert result.steps == len(result.history.loss) == 30
    assert result.history.levels == {"level 0": 0}
    assert result.parameters > 0
    assert len(result.candidates) > 0
    assert result.render().rgb.shape == (2, 64, 64, 3)


@every_name
def test_held_out_views_are_rendered_before_the_background(name, photographed):
    seen = reconstructed(name, photographed).render()
    empty = seen.opacity == 0
    assert empty[:, [0, 0, -1, -1], [0, -1, 0, -1]].all()  # no point is ever that far out
    assert (seen.rgb[empty] == 255).all()


@every_name
@pytest.mark.parametrize("cloud", ["confident", "surface"])
def test_confident_points_are_of_the_candidates(name, cloud, photographed):
    """They are some of all that have a density, but for a few that stand beside such a point and
    are sure through it; surface points lie between the cloud's points."""
    result = reconstructed(name, photographed, cloud)
    known = {tuple(point) for point in result.candidates.points_mm.tolist()}
    same = [tuple(p) in known for p in result.points_mm.astype(np.float32).tolist()]
    # a tent is made sure at all eight corners of a cell, of which some stand beside matter
    least = {"nerf": 0.5, "industnerf_plus": 0.5, "industnerf_depth": 0.9}.get(name, 0.95)
    assert np.mean(same) > least if cloud == "confident" else not any(same)
