"""What MLflow is given: curves, one table, pictures."""

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.history import History
from industnerf.artifacts.renderings import Renderings
from industnerf.artifacts.views import RgbdImage, Views, save_views
from industnerf.geometry.cameras import Cameras, look_at, pinhole
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.mlflow_artifacts import (
    MAX_CURVE_POINTS,
    loss_curve,
    mean_costs,
    per_part_table,
    preview_image,
)
from tests.archives import opened

SIDE = 8
SCORES = """\
part_id,family,method,split,metric,protocol,value,status
a,gears,hull,test,emd,P1-even,0.1,ok
a,gears,hull,test,emd,P1-iid,0.2,ok
a,gears,net,test,emd,P1-even,0.3,failed
a,gears,net,test,emd,P1-iid,0.4,ok
a,gears,net,test,psnr,P1-union,20,ok
b,gears,hull,dev,emd,P1-even,0.5,ok
"""
COSTS = """\
stage,method,part_id,seconds,peak_mb,device,extra_seconds
views,,a,100,900,cpu,0
reconstruct,hull,a,1,50,cpu,0.5
reconstruct,hull,b,3,70,cpu,0.5
evaluate,hull,a,100,900,cpu,0
"""


def save_history(clouds: Path, part: str, steps, loss) -> None:
    (clouds / part).mkdir(parents=True)
    History(np.asarray(steps), np.asarray(loss, float), {"level 0": 0}).save(clouds / part)


def test_a_short_curve_is_the_mean_of_the_parts(tmp_path):
    save_history(tmp_path, "a", [0, 1, 2], [4, 2, 1])
    save_history(tmp_path, "b", [0, 1], [2, 0])
    (tmp_path / "without").mkdir()
    assert loss_curve(tmp_path) == {0: 3, 1: 1, 2: 1}


@pytest.mark.parametrize(
    "length",
    [MAX_CURVE_POINTS, MAX_CURVE_POINTS + 1, 2 * MAX_CURVE_POINTS - 1, 7 * MAX_CURVE_POINTS, 1234],
)
def test_a_long_curve_is_thinned_and_keeps_its_course(tmp_path, length):
    """Of a loss that falls by 1 a step, each stretch's mean is the middle of its own steps."""
    save_history(tmp_path, "a", np.arange(length), -np.arange(length))
    curve = loss_curve(tmp_path)
    starts = [*curve, length]
    assert len(curve) == MAX_CURVE_POINTS
    assert starts[0] == 0
    for start, end in pairwise(starts):
        assert curve[start] == -(start + end - 1) / 2  # sums of small whole numbers: exact


def test_steps_that_were_not_kept_leave_no_gap(tmp_path):
    save_history(tmp_path, "a", [0, 700, 1000], [4, 2, 1])
    assert list(loss_curve(tmp_path).values()) == [4, 2, 1]


def test_no_history_is_no_curve(tmp_path):
    assert loss_curve(tmp_path) == {}


@pytest.fixture
def report(tmp_path):
    (tmp_path / "scores.csv").write_text(SCORES)
    (tmp_path / "cost.csv").write_text(COSTS)
    return tmp_path


def test_the_table_has_a_row_a_part_and_method(report):
    table = per_part_table(report)
    rows = {(row.pop("part_id"), row.pop("method")): row for row in table.to_dict("records")}
    assert set(rows) == {("a", "hull"), ("a", "net"), ("b", "hull")}
    assert rows["a", "net"] == {
        "family": "gears",
        "split": "test",
        "emd P1-even": 0.3,
        "emd P1-iid": 0.4,
        "psnr P1-union": 20,
        "status": "failed",
        "seconds": None,
        "peak_mb": None,
    }
    assert rows["a", "hull"]["status"] == "ok"
    assert (rows["b", "hull"]["seconds"], rows["b", "hull"]["peak_mb"]) == (3, 70)


def test_the_table_is_json_that_browsers_read(report):
    """NaN would not be."""
    json.dumps(per_part_table(report).to_dict("records"), allow_nan=False)


def test_costs_are_those_of_reconstructions(report):
    assert mean_costs(report) == {"hull.seconds": 2, "hull.peak_mb": 60}


@pytest.fixture
def study(tmp_path):
    """Ten parts photographed in a gray of their own and rendered lighter."""
    eyes = 300 * fibonacci_sphere(3)
    cameras = Cameras(
        np.tile(pinhole(35.0, SIDE), (3, 1, 1)), look_at(eyes, np.zeros(3)), SIDE, SIDE
    )
    flat = np.zeros((SIDE, SIDE))
    for i in range(10):
        held_out = np.array([False, True, True])
        views = Views(
            tmp_path / "views" / f"p{i}", f"p{i}", cameras, held_out, np.ones((3, 3)), 0.1, 1.0
        )
        grays = [np.full((SIDE, SIDE, 3), 10 * i + view, np.uint8) for view in range(3)]
        save_views(views, [RgbdImage(gray, flat > 0, flat.astype(np.float32)) for gray in grays])
        cloud = tmp_path / "clouds" / f"p{i}"
        cloud.mkdir(parents=True)
        renderings = np.stack(grays[1:]) + np.uint8(100)
        depth = np.zeros((2, SIDE, SIDE), np.float32)
        Renderings(renderings, depth, depth.astype(np.uint8)).save(cloud)
        origin_point = np.zeros((1, 3), np.float32)  # where every camera looks
        color, confidence = np.array([[200, 0, 0]], np.uint8), np.ones(1, np.float32)
        Cloud(f"p{i}", origin_point, color, confidence, np.zeros(1, np.int16), 0, 0).save(cloud)
    return tmp_path


def test_the_photograph_stands_beside_the_rendering_of_the_same_camera(study):
    image = preview_image(study / "clouds", study / "views")
    assert image.shape == (4 * SIDE, 2 * SIDE, 3)
    np.testing.assert_array_equal(image[::SIDE, 0, 0], [1, 31, 61, 91])
    np.testing.assert_array_equal(image[::SIDE, SIDE, 0], [101, 131, 161, 191])


def test_without_renderings_the_points_are_drawn(study):
    for folder in (study / "clouds").iterdir():
        (folder / "renderings.zip").unlink()
    image = preview_image(study / "clouds", study / "views")
    assert image.shape == (4 * SIDE, 2 * SIDE, 3)
    assert tuple(image[SIDE // 2, SIDE + SIDE // 2]) == (200, 0, 0)
    assert (image[0, SIDE] == 255).all()


def test_without_a_held_out_camera_there_is_no_picture(study):
    for archive in (study / "views").glob("*/photographs.zip"):
        with opened(archive) as folder:
            path = folder / "cameras.json"
            path.write_text(path.read_text().replace('"held_out": true', '"held_out": false'))
    assert preview_image(study / "clouds", study / "views") is None


def test_without_clouds_there_is_no_picture(study):
    assert preview_image(study / "views", study / "views") is None
