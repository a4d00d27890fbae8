"""From a method that renders to Table 2, through the stages themselves."""

import json
from dataclasses import replace

import numpy as np
import pytest

from industnerf import config
from industnerf.artifacts.scores import Score, load_scores
from industnerf.artifacts.views import load_views
from industnerf.errors import ReconstructionFailed
from industnerf.stage import read_failures, read_index
from pipeline.stages import evaluate, reconstruct, report
from tests.methods.caster import CASTER, GRAY

NAME = "oracle"  # whose points the caster returns: its settings and its seed are taken
pytestmark = pytest.mark.slow  # of a finished run
FAILING_PART, WORKING_PART = "enclosure-120x80x40", "clevis-din71752-g12x24"


def cast_all_but_the_enclosure(inputs, settings, state, seed):
    if np.ptp(inputs.own_mesh.vertices, axis=0).max() > 110:
        raise ReconstructionFailed("empty: too large for this test")
    return CASTER.reconstruct(inputs, settings, state, seed)


@pytest.fixture(scope="module")
def stages(finished_run, tmp_path_factory):
    """Folders of clouds, scores and the report, made by the stages from a finished run's data."""
    folder, data = tmp_path_factory.mktemp("rendered"), finished_run.folder / "data"
    params = config.load_params(finished_run.folder / "params.yaml")
    params = replace(params, methods=[NAME])
    method = replace(CASTER, name=NAME, reconstruct=cast_all_but_the_enclosure)

    def cfg(stage):
        return config.load_stage(stage, finished_run.folder / "dvc.yaml").select_params(params)

    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("INDUSTNERF_STORE", str(folder / "store"))
        patch.setenv("INDUSTNERF_RUNNER", "serial")
        patch.setattr(reconstruct, "load_method", lambda name: method)
        names = ("parts", "views", "split.json", "truth", "states")
        parts, views, split, truth, states = (str(data / name) for name in names)
        clouds, scores = (str(folder / name) for name in ("clouds", "scores"))
        reconstruct.main(cfg("reconstruct"), parts, views, split, states, clouds)
        evaluate.main(cfg("evaluate"), parts, views, truth, clouds, scores)
        solids, procedural = str(data / "solids"), str(data / "procedural")
        input_paths = (solids, parts, views, split, truth, procedural, states)
        folders = ("clouds", "scores", "no grid", "no seeds", "reports")
        output_paths = (str(folder / name) for name in folders)
        report.main(cfg("report"), *input_paths, *output_paths)
    return folder


def part_scores(folder, part) -> dict[tuple[str, str], Score]:
    return {(s.metric, s.protocol): s for s in load_scores(folder / "scores" / NAME / part)}


def test_what_comes_with_the_points_changes_no_score_of_the_points(stages, finished_run):
    oracle_scores = load_scores(finished_run.folder / "data" / "scores" / NAME / WORKING_PART)
    caster_scores = load_scores(stages / "scores" / NAME / WORKING_PART)
    assert caster_scores[: len(oracle_scores)] == oracle_scores
    # of pictures; three of confidence, and nine points of its curve
    assert len(caster_scores) == len(oracle_scores) + 10 + 3 + 9


def test_rays_cast_at_the_truth_are_the_truth_but_for_its_colors(stages, finished_run):
    scores = part_scores(stages, WORKING_PART)
    assert scores["coverage", "P1-union"].value == 1
    assert scores["silhouette_iou", "P1-union"].value == 1
    # two roundings to 16 bits of at most 5.1 radii, 2.55 diagonals: 2e-5 diagonals each
    assert scores["depth_mse", "P1-union"].value < (2 * 2e-5) ** 2
    views = load_views(finished_run.folder / "data" / "views" / WORKING_PART)
    held_out = np.flatnonzero(views.held_out)
    (image,), (mask,) = views.rgb(held_out), views.mask(held_out)
    expected = ((image[mask] / 255 - GRAY / 255) ** 2).mean()
    assert scores["rgb_mse", "P1-union"].value == pytest.approx(expected, rel=1e-12)


def test_confidence_that_falls_with_the_distance_is_found_to(stages):
    scores = part_scores(stages, WORKING_PART)
    # Candidates stray in three directions and the surface is two-dimensional, so confidence
    # bounds the error from above alone; far from chance, yet not the true order.
    assert -1 < scores["confidence_spearman", "P1-near"].value < -0.2
    chance = scores["confidence_ause_chance", "P1-near"].value
    assert 0 < scores["confidence_ause", "P1-near"].value < 0.8 * chance


def test_a_failed_part_has_no_invented_pictures_and_is_counted(stages):
    failed = part_scores(stages, FAILING_PART)
    assert not {"rgb_mse", "depth_mse", "confidence_ause"} & {metric for metric, _ in failed}
    assert ("emd", "P1-even") in failed
    text = (stages / "reports" / "table2.md").read_text()
    assert "RGB 2D (MSE)" in text
    metrics = json.loads((stages / "reports" / "summary.json").read_text())["metrics"]
    assert sum(name.endswith(".rgb_mse") for name in metrics) == 1


def test_the_store_knows_the_photographs_that_the_renderings_are_held_against(stages, finished_run):
    """A method that does not render does not depend on them."""
    data, tasks = finished_run.folder / "data", []
    params = config.load_params(finished_run.folder / "params.yaml")
    cfg = config.load_stage("evaluate", finished_run.folder / "dvc.yaml").select_params(params)
    for clouds in (stages / "clouds", data / "clouds"):
        folders = (data / "parts", data / "truth", data / "views", clouds / NAME)
        failed = set(read_failures(clouds / NAME))
        tasks += evaluate.evaluation_tasks(cfg, folders, read_index(data / "truth"), failed)
    rendered, without_renderings = (
        {path.name for task in method_tasks if task.part_id == WORKING_PART for path in task.inputs}
        for method_tasks in (tasks[:2], tasks[2:])
    )
    assert without_renderings == {"mesh.npz", WORKING_PART, "cloud.npz"}
    assert rendered - without_renderings == {
        "renderings.zip",
        "candidates.npz",
        "cameras.json",
        "rgb",
        "mask",
        "depth",
    }
