"""Clouds from outside, through the stages that score a method's."""

import csv
import re
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.part import Mesh
from industnerf.artifacts.ply import write_ply
from industnerf.config import load_params
from industnerf.errors import BadArtifact, BadParams, MetricError, PartsFailed
from industnerf.external.density import density_warnings
from industnerf.external.points import read_cloud
from industnerf.external.table import COLUMNS
from pipeline import score
from pipeline.stages import evaluate
from tests.conftest import ROOT

SIDES = np.array([20.0, 30.0, 40.0])


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with a block as a CAD file, and a study that is quick to measure."""
    for name in ("dvc.yaml", "params.yaml"):
        (tmp_path / name).symlink_to(ROOT / name)
    trimesh.creation.box(SIDES).export(tmp_path / "block.stl")
    params = load_params(ROOT / "params.yaml")
    quick_params = replace(
        params, evaluate=replace(params.evaluate, points=128, dense_samples=2048, max_points=2048)
    )
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(score, "load_params", lambda: quick_params)
    monkeypatch.setenv("INDUSTNERF_RUNNER", "serial")
    monkeypatch.setenv("INDUSTNERF_STORE", str(tmp_path / "store"))
    return tmp_path


def emd(folder, name: str) -> tuple[float, float, str]:
    """EMD (even), floor and status of the block."""
    with (folder / "runs" / "score" / name / "scores" / "scores.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["protocol"] == "P1-even"]
    (row,) = (row for row in rows if row["metric"] == "emd")
    return float(row["value"]), float(row["floor"]), row["status"]


def test_the_true_surface_scores_its_floor_and_says_every_metric(folder, capsys):
    trimesh.creation.box(SIDES).export(folder / "same.ply")
    score.main("same.ply", "block.stl")
    value, floor, status = emd(folder, "same")
    # another sample of the same 128 points: a fifth is what the oracle's test allows
    assert status == "ok"
    assert value == pytest.approx(floor, rel=0.2)
    output = capsys.readouterr().out
    assert "outside the study: 1 parts" in output
    for head in COLUMNS[1:-1]:  # each is explained below the table
        assert head in output
        assert re.search(rf"(?m)^{re.escape(head.removesuffix(', mm'))}: ", output)
    assert "every metric: runs/score/same/scores/scores.csv" in output


def test_a_cloud_elsewhere_scores_about_how_far_it_was_moved(folder, capsys):
    points = trimesh.creation.box(SIDES).sample(2048, seed=1) + np.array([30.0, 0, 0])
    write_ply(folder / "moved.ply", points)
    score.main("moved.ply", "block.stl")
    value, floor, _ = emd(folder, "moved")
    assert value == pytest.approx(30 / np.linalg.norm(SIDES), abs=floor)
    assert "is it in the cameras' frame?" in capsys.readouterr().out


def test_the_unit_of_the_cad_file_is_suspected_too(folder, capsys):
    trimesh.creation.box(SIDES / 1000).export(folder / "meters.ply")
    score.main("meters.ply", "block.stl")
    assert "in mm, and the CAD file too (parts.units" in capsys.readouterr().out


def test_a_file_without_points_is_a_failure_and_scores_as_one(folder, capsys):
    (folder / "torn.ply").touch()
    with pytest.raises(BadArtifact, match="the cloud could not be scored; the reason"):
        score.main("torn.ply", "block.stl")
    assert emd(folder, "torn")[2] == "failed"
    output = capsys.readouterr().out
    assert "block failed: torn.ply cannot be read" in output
    assert "1 failed" in output


def test_where_one_of_two_clouds_is_read_all_is_well(folder, capsys):
    (folder / "two").mkdir()
    ids = ("nut-square-din557-m12", "gear-spur-m2-z24")
    trimesh.creation.box(SIDES).export(folder / "two" / f"{ids[0]}.ply")
    (folder / "two" / f"{ids[1]}.ply").touch()
    score.main("two")
    assert f"{ids[1]} failed: " in capsys.readouterr().out


def test_where_two_clouds_fail_it_says_of_how_many(folder):
    (folder / "two").mkdir()
    for part_id in ("nut-square-din557-m12", "gear-spur-m2-z24"):
        (folder / "two" / f"{part_id}.ply").touch()
    with pytest.raises(BadArtifact, match="none of 2 clouds could be scored; the reasons"):
        score.main("two")


def test_a_metric_that_fails_gives_no_score(folder, monkeypatch):
    def torn(*_, **__):
        raise MetricError("no proof that the distance is exact")

    torn.__module__ = evaluate.score_part.__module__  # by which its code is looked up
    monkeypatch.setattr(evaluate, "score_part", torn)
    trimesh.creation.box(SIDES).export(folder / "same.ply")
    with pytest.raises(PartsFailed, match=r"(?s)block: no proof that .* lost by .* a metric"):
        score.main("same.ply", "block.stl")
    assert not list(folder.glob("runs/score/same/scores/*.csv"))


def test_a_cad_file_that_does_not_exist_is_called_that(folder):
    (folder / "a.ply").touch()
    with pytest.raises(BadParams, match=r"^nosuch\.step does not exist"):
        score.main("a.ply", "nosuch.step")
    assert not (folder / "runs").exists()


def test_what_was_asked_before_is_made_anew_and_nothing_else_is_removed(folder):
    trimesh.creation.box(SIDES).export(folder / "same.ply")
    score.main("same.ply", "block.stl")
    out = folder / "runs/score/same"
    (out / "notes.txt").write_text("mine")
    (out / "scores/gone.txt").touch()
    score.main("same.ply", "block.stl")
    assert (out / "notes.txt").read_text() == "mine"
    assert not (out / "scores/gone.txt").exists()
    assert [path.name for path in (folder / "runs/score").iterdir()] == ["same"]


def test_another_part_or_another_place_of_one_name_leaves_the_report_that_is_there(folder, capsys):
    trimesh.creation.box(SIDES).export(folder / "same.ply")
    score.main("same.ply", "block.stl")
    trimesh.creation.box(SIDES).export(folder / "brick.stl")
    score.main("same.ply", "brick.stl")
    part_of_report = {"same": "block", "same-2": "brick"}
    for name, part in part_of_report.items():
        scores = folder / "runs/score" / name / "scores"
        assert [path.name for path in scores.glob("*/")] == [part]
    assert "every metric: runs/score/same-2/scores/scores.csv" in capsys.readouterr().out


@pytest.mark.parametrize("lies_there", ["cloud", "part"])
def test_nothing_is_removed_where_what_is_to_be_scored_lies(folder, lies_there):
    report_dir = folder / "runs/score/same"
    (report_dir / "clouds").mkdir(parents=True)
    cloud, part = folder / "same.ply", folder / "block.stl"
    trimesh.creation.box(SIDES).export(cloud)
    moved = {"cloud": cloud, "part": part}[lies_there]
    moved = moved.rename(report_dir / "clouds" / moved.name)
    arguments = {"cloud": cloud, "part": part} | {lies_there: moved}
    with pytest.raises(BadParams, match="lies in runs/score/same, where its own report would go"):
        score.main(str(arguments["cloud"]), str(arguments["part"]))
    assert moved.is_file()


def test_the_study_is_set_beside_what_was_scored_as_it_was_and_else_it_is_said_why(monkeypatch):
    monkeypatch.chdir(ROOT)
    params = load_params()
    study_scores, reason = score.published_scores(params)
    assert reason == ""
    assert len(study_scores.values["hull"]) == len(study_scores.splits)
    study_scores, reason = score.published_scores(replace(params, seed=params.seed + 1))
    assert reason == "params.yaml has another seed"
    assert study_scores.values == {}
    assert study_scores.splits
    own_params = replace(params, parts=replace(params.parts, source="path"))
    study_scores, reason = score.published_scores(own_params)
    assert reason == "its parts are not your CAD file"  # whatever that is called
    assert (study_scores.splits, study_scores.values) == ({}, {})


def test_a_part_of_the_suite_is_brought_in_by_its_name(folder):
    trimesh.creation.box(SIDES).export(folder / "nut-square-din557-m12.ply")
    params, _ = score.resolve_inputs(
        score.load_params(), folder / "nut-square-din557-m12.ply", "", None
    )
    assert params.parts.select == ["nut-square-din557-m12"]
    score.main("nut-square-din557-m12.ply")
    assert (folder / "runs/score/nut-square-din557-m12/scores/nut-square-din557-m12").is_dir()


def test_a_part_that_is_not_known_is_refused_before_anything_is_done(folder):
    (folder / "a.ply").touch()
    with pytest.raises(BadParams, match="no part is called 'a'"):
        score.main("a.ply")
    assert not (folder / "runs").exists()


def test_what_is_remarked_on_is_printed_and_splats_are_left_out_on_request(folder, capsys):
    """400 points of a block, some of which are not finite, some hardly opaque."""
    points = trimesh.creation.box(SIDES).sample(400, seed=1)
    table = np.hstack([points, np.full((400, 2), 5.0)]).astype("<f4")
    table[:100, 4] = -5  # the logit of an opacity of 0.007
    table[-3:, 1] = np.nan
    names = ("x", "y", "z", "scale_0", "opacity")
    properties = "".join(f"property float {name}\n" for name in names)
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex 400\n{properties}end_header\n"
    (folder / "splats.ply").write_bytes(head.encode() + table.tobytes())
    score.main("splats.ply", "block.stl")
    output = capsys.readouterr().out
    assert "block: 3 of its 400 points are not finite and are left out" in output
    assert "the centers of 400 of 400 are taken as points; 100 of them have an opacity" in output
    assert "397 points, of which the 128 most evenly spread are compared" in output
    score.main("splats.ply", "block.stl", min_opacity="0.5")
    assert "the centers of 300 of 400 are taken as points\n" in capsys.readouterr().out
    with pytest.raises(BadParams, match=r"--min-opacity most: must be a number from 0 to 1"):
        score.main("splats.ply", "block.stl", min_opacity="most")


CASES = ROOT.parent / "shared" / "cases"


@pytest.mark.skipif(not CASES.is_dir(), reason="needs ../shared/cases")
@pytest.mark.parametrize(
    ("case", "warning"),
    [
        ("50-cloud-control/in/c.xyz", ""),
        ("54-cloud-nan-rows/in/c.ply", "are not finite and are left out"),
        ("57-mesh-glb/in/m.glb", "are drawn of it, evenly by area"),
    ],
)
def test_the_shared_cases_are_scored_with_their_remarks(folder, capsys, case, warning):
    path = CASES / case
    score.main(str(path), str(path.parents[1] / "plate.stl"))
    assert warning in capsys.readouterr().out
    value, floor, status = emd(folder, path.stem)
    assert (status, value < 2.5 * floor) == ("ok", True)


@pytest.mark.skipif(not CASES.is_dir(), reason="needs ../shared/cases")
def test_of_the_shared_cloud_of_4000_points_the_few_are_remarked_on(tmp_path):
    """It scored 1.70 floors, being perfect."""
    case = CASES / "50-cloud-control"
    plate = trimesh.load(case / "plate.stl")
    mesh = Mesh.with_one_appearance(plate.vertices, plate.faces.astype(np.int32))
    content = read_cloud(case / "in" / "c.xyz", 1, np.random.default_rng(0))
    compared = load_params(ROOT / "params.yaml").evaluate.points
    (warning,) = density_warnings(content.points, mesh, compared, np.random.default_rng(0))
    assert "4000 points, fewer than the 4096 that are compared: so many perfect points" in warning
    assert "score about 1.7 floors; write 16384 or more" in warning
