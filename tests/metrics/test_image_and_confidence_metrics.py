"""Scores of renderings and candidates: of the right files, in the right unit, or of none."""

from pathlib import Path

import numpy as np
import pytest

from industnerf.artifacts.candidates import Candidates
from industnerf.artifacts.renderings import Renderings
from industnerf.artifacts.truth import Truth
from industnerf.artifacts.views import RgbdImage as Photograph
from industnerf.artifacts.views import Views, save_views
from industnerf.errors import MetricError
from industnerf.geometry.cameras import Cameras, look_at, pinhole
from industnerf.geometry.sampling import ball_surface
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.metrics.image_and_confidence_metrics import (
    MAX_CANDIDATE_DISTANCE,
    REMOVED_PERCENTS,
    image_and_confidence_files,
    image_and_confidence_scores,
)
from industnerf.metrics.reference_rig import ReferenceSurface
from tests.solids import ball

RADIUS, SIDE = 20.0, 12
REFERENCE = ReferenceSurface(ball(RADIUS))
HELD_OUT = np.array([False, True, False, True])
DEPTH_OFFSET = 0.05  # diagonals that the rendered depth is too deep


def truth(visible: np.ndarray | None = None, count: int = 20_000) -> Truth:
    points = RADIUS * fibonacci_sphere(count)
    visible_mask = np.ones(len(points), bool) if visible is None else visible
    return Truth(points.astype(np.float32), visible_mask, {})


@pytest.fixture
def images() -> list[Photograph]:
    """Each view is of another color and depth, so that none can be taken for another."""
    mask = np.zeros((SIDE, SIDE), bool)
    mask[2:8, 3:9] = True
    return [
        Photograph(
            np.full((SIDE, SIDE, 3), 10 * view, np.uint8),
            mask,
            np.where(mask, 100.0 + 7 * view, 0).astype(np.float32),
        )
        for view in range(len(HELD_OUT))
    ]


@pytest.fixture
def views(tmp_path, images) -> Path:
    count = len(HELD_OUT)
    cameras = Cameras(
        np.tile(pinhole(30.0, SIDE), (count, 1, 1)),
        look_at(120 * fibonacci_sphere(count), np.zeros(3)),
        SIDE,
        SIDE,
    )
    step = 0.01  # mm of depth
    views = Views(tmp_path / "views", "p", cameras, HELD_OUT, np.ones((count, 3)), step, 1.0)
    save_views(views, images)
    return views.folder


def save_renderings(
    images: list[Photograph], cloud: Path, is_held_out: np.ndarray = HELD_OUT
) -> None:
    """What a method would see that gets the colors right, and the depth wrong by OFF."""
    held_out_images = [
        image for image, is_wanted in zip(images, is_held_out, strict=True) if is_wanted
    ]
    mask = np.stack([image.mask for image in held_out_images])
    depth = (
        np.stack([image.depth_mm for image in held_out_images])
        + DEPTH_OFFSET * REFERENCE.diagonal_mm * mask
    )
    opacity = np.where(mask, 255, 0).astype(np.uint8)
    Renderings(
        np.stack([image.rgb for image in held_out_images]), depth.astype(np.float32), opacity
    ).save(cloud)


def scores_of(
    views: Path, cloud: Path, ground_truth: Truth | None = None
) -> dict[tuple[str, str], float]:
    rows = image_and_confidence_scores(REFERENCE, ground_truth or truth(), views, cloud)
    assert {row.status for row in rows} <= {"ok"}
    return {(row.metric, row.protocol): row.value for row in rows}


def test_what_was_not_returned_has_no_score_and_no_file(views, tmp_path):
    (tmp_path / "cloud").mkdir()
    assert scores_of(views, tmp_path / "cloud") == {}
    assert image_and_confidence_files(views, tmp_path / "cloud") == ()


def test_renderings_are_held_against_the_held_out_photographs_in_diagonals(views, images, tmp_path):
    cloud = tmp_path / "cloud"
    save_renderings(images, cloud)
    values = scores_of(views, cloud)
    assert values["rgb_mse", "P1-union"] == 0
    assert values["coverage", "P1-union"] == values["silhouette_iou", "P1-union"] == 1
    # two roundings to 16 bits, by up to 0.005 and 0.001 mm, of 3.5 mm: 0.2 %, squared twice that
    assert values["depth_mse", "P1-union"] == pytest.approx(DEPTH_OFFSET**2, rel=4e-3)
    assert values["depth_mse", "P1-frame"] == pytest.approx(36 / 144 * DEPTH_OFFSET**2, rel=4e-3)


def test_no_score_of_the_renderings_is_better_than_its_best(views, images, tmp_path):
    save_renderings(images, tmp_path / "cloud")
    for row in image_and_confidence_scores(REFERENCE, truth(), views, tmp_path / "cloud"):
        if row.metric in ("rgb_mse", "psnr", "ssim", "coverage", "silhouette_iou"):
            assert row.value == pytest.approx(row.floor, abs=1e-12)  # the colors are perfect
        else:
            assert row.value > row.floor


def test_renderings_of_other_views_are_refused(views, images, tmp_path):
    save_renderings(images, tmp_path / "cloud", np.ones(4, bool))
    with pytest.raises(MetricError, match="4 renderings of 2 held-out views"):
        scores_of(views, tmp_path / "cloud")


def test_files_are_the_renderings_and_the_photographs(views, images, tmp_path):
    cloud = tmp_path / "cloud"
    save_renderings(images, cloud)
    Candidates(np.zeros((2, 3), np.float32), np.ones(2, np.float32)).save(cloud)
    names = {str(path.relative_to(tmp_path)) for path in image_and_confidence_files(views, cloud)}
    photographs = {
        f"views/photographs.zip/{name}" for name in ("cameras.json", "rgb", "mask", "depth")
    }
    assert names == photographs | {"cloud/renderings.zip", "cloud/candidates.npz"}


def save_shell_candidates(cloud: Path, decay: float) -> None:
    """Candidates at even distances outside the ball, to 0.1 diagonals.

    Confidence falls exponentially at the rate `decay`, but beyond 0.05 it all turns round.
    """
    rng = np.random.default_rng(0)
    distances = np.linspace(0, 0.1, 4000)
    radii = (RADIUS + distances * REFERENCE.diagonal_mm)[:, None]
    points = ball_surface(np.full(3, 2.0), np.zeros(3), len(distances), rng) * radii
    confidence = np.exp(-decay * np.where(distances < 0.05, distances, 0.1 - distances))
    cloud.mkdir()
    Candidates(points.astype(np.float32), confidence.astype(np.float32)).save(cloud)


@pytest.mark.parametrize(("decay", "rank", "area"), [(5.0, -1, 0), (-1.0, 1, 1)])
def test_candidates_are_asked_near_the_surface_alone(views, tmp_path, decay, rank, area):
    """Their errors are even up to NEAR: the curves are those of lines (see test_calibration)."""
    save_shell_candidates(tmp_path / "cloud", decay)
    ground_truth = truth(count=200_000)
    values = scores_of(views, tmp_path / "cloud", ground_truth)
    rows = image_and_confidence_scores(REFERENCE, ground_truth, views, tmp_path / "cloud")
    best = {row.metric: row.floor for row in rows}
    # distance is to samples 0.16 mm apart, so up to 0.1 mm counts where 0 should, of errors up to
    # 3.5 mm: all but the smallest keep their rank, and the curves move by less than 1 %
    assert values["confidence_spearman", "P1-near"] == pytest.approx(rank, abs=0.01)
    assert values["confidence_ause", "P1-near"] == pytest.approx(area, abs=0.01)
    assert values["confidence_ause_chance", "P1-near"] == pytest.approx(0.5, abs=0.01)
    for percent in (10, 50, 90):
        left = values[f"error_left_{percent}", "P1-near"]
        assert left == pytest.approx(1 + rank * percent / 100, abs=0.02)
        assert best[f"error_left_{percent}"] == pytest.approx(1 - percent / 100, abs=0.02)


def test_hidden_surface_draws_no_candidates_but_is_no_error(views, tmp_path):
    """Only the upper half is visible: candidates on the lower are near it at the rim alone."""
    ground_truth = truth(visible=fibonacci_sphere(20_000)[:, 2] > 0)
    points = RADIUS * fibonacci_sphere(5000)
    cloud = tmp_path / "cloud"
    cloud.mkdir()
    Candidates(points.astype(np.float32), np.ones(5000, np.float32)).save(cloud)
    kinds = {(f"confidence_{name}", "P1-near") for name in ("spearman", "ause", "ause_chance")}
    kinds |= {(f"error_left_{percent}", "P1-near") for percent in REMOVED_PERCENTS}
    assert set(scores_of(views, cloud, ground_truth)) == kinds
    below = points[points[:, 2] < -2 * MAX_CANDIDATE_DISTANCE * REFERENCE.diagonal_mm]
    Candidates(below.astype(np.float32), np.ones(len(below), np.float32)).save(cloud)
    assert scores_of(views, cloud, ground_truth) == {}
