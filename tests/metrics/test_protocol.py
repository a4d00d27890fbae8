"""Protocol P1 on solids whose visible surface is known."""

from dataclasses import replace
from pathlib import Path

import fpsample
import numpy as np
import pytest
import trimesh

from industnerf.artifacts.cloud import Cloud, save_extra_clouds
from industnerf.artifacts.part import Mesh
from industnerf.artifacts.scores import load_scores
from industnerf.artifacts.truth import Truth
from industnerf.errors import MetricError
from industnerf.geometry.sampling import ball_surface, box_surface, sample_surface
from industnerf.metrics.protocol import score_failure, score_part
from industnerf.metrics.reference_rig import ReferenceRig, ReferenceSurface, evaluated_mask
from industnerf.metrics.truth import measure_truth
from industnerf.schema import EvaluateParams

SETTINGS = EvaluateParams(
    points=256,
    dense_samples=4096,
    max_points=4096,
    visibility_views=40,
    visibility_radius=4.1,
    occlusion_margin=0.01,
    fscore_threshold=0.02,
    tolerances_mm=[0.5, 1.0],
)
SIDE, CAVITY = 20.0, 10.0  # mm


def hollow_box() -> Mesh:
    """A cube with a closed cavity that nobody can see."""
    outer, inner = trimesh.creation.box([SIDE] * 3), trimesh.creation.box([CAVITY] * 3)
    faces = np.concatenate([outer.faces, inner.faces[:, ::-1] + len(outer.vertices)])
    return Mesh.with_one_appearance(
        np.concatenate([outer.vertices, inner.vertices]), faces.astype(np.int32)
    )


def surface_samples(mesh, count=2000, seed=0):
    return sample_surface(mesh.vertices, mesh.faces, count, np.random.default_rng(seed))[0]


def is_on_cavity(points):
    """Points of the cavity lie within half its side, those of the outside do not."""
    return np.abs(points).max(axis=1) < (SIDE + CAVITY) / 4


def test_the_rig_sees_the_outside_all_of_it_and_nothing_else():
    points = surface_samples(hollow_box())
    is_visible = ReferenceRig(ReferenceSurface(hollow_box()), SETTINGS).is_visible(points)
    np.testing.assert_array_equal(is_visible, ~is_on_cavity(points))


def test_only_deep_points_nearer_to_hidden_truth_are_left_out():
    mesh, truth = hollow_box(), surface_samples(hollow_box())
    rig = ReferenceRig(ReferenceSurface(mesh), SETTINGS)
    on_cavity, just_beneath = truth[is_on_cavity(truth)], np.array([[0.0, 0.0, 0.9 * SIDE / 2]])
    predicted = np.concatenate([truth[~is_on_cavity(truth)], just_beneath, on_cavity])
    mask = evaluated_mask(rig, predicted, truth, ~is_on_cavity(truth), SETTINGS.occlusion_margin)
    # 1 mm beneath the surface is deeper than 1 % of the diagonal (0.35 mm), but far from the cavity
    np.testing.assert_array_equal(mask, np.arange(len(predicted)) < len(predicted) - len(on_cavity))


def test_nothing_is_left_out_where_nothing_is_hidden():
    mesh = hollow_box()
    deep = np.zeros((3, 3))
    mask = evaluated_mask(
        ReferenceRig(ReferenceSurface(mesh), SETTINGS),
        deep,
        surface_samples(mesh),
        np.ones(2000, bool),
        0.01,
    )
    assert mask.all()


@pytest.fixture
def part(tmp_path):
    """A hollow box on disk, with its truth; returns what makes and scores a cloud of it."""
    return Case(tmp_path / "a", hollow_box())


class Case:
    """One part on disk."""

    def __init__(self, folder: Path, mesh: Mesh, name: str = "part") -> None:
        self.mesh, self.folder = mesh, folder
        for part in (name, "truth", "cloud", "scores"):
            (folder / part).mkdir(parents=True)
        self.part = folder / name
        np.savez_compressed(self.part / "mesh.npz", **vars(mesh))
        measure_truth(self.part, folder / "truth", settings=SETTINGS, seed=0)

    def scores(self, points: np.ndarray) -> dict[tuple[str, str], float]:
        n = len(points)
        gray = np.zeros((n, 3), np.uint8)
        confidence = np.ones(n, np.float32)
        view = np.zeros(n, np.int16)
        Cloud("part", points.astype(np.float32), gray, confidence, view, 0, 0).save(
            self.folder / "cloud"
        )
        names = ("truth", "views", "cloud", "scores")
        score_part(self.part, *map(self.folder.joinpath, names), settings=SETTINGS, seed=0)
        return self.read()

    def failure(self) -> dict[tuple[str, str], float]:
        truth, target = self.folder / "truth", self.folder / "scores"
        score_failure(self.part, truth, target, settings=SETTINGS, seed=0)
        return self.read()

    def read(self) -> dict[tuple[str, str], float]:
        self.rows = load_scores(self.folder / "scores")
        return {(row.metric, row.protocol): row.value for row in self.rows}


def test_a_perfect_cloud_of_the_outside_is_at_the_floor_and_lacks_the_hidden_part(part):
    truth = Truth.load(part.folder / "truth")
    points = surface_samples(part.mesh, 8000, seed=5)
    values = part.scores(points[~is_on_cavity(points)])
    # both are distances between independent samples of one surface; 256 points agree to 10 %
    assert values["emd", "P1-even"] == pytest.approx(truth.floors["emd P1-even"].value, rel=0.1)
    # a fifth of the whole surface is the cavity, which this cloud has not: that mass moves 5 mm
    # or more, 0.14 diagonals, where the floor moves 0.045; seen here: 1.43 floors
    assert values["emd", "P1-full"] > 1.2 * truth.floors["emd P1-full"].value
    assert {row.status for row in part.rows} == {"ok"}


def test_scores_do_not_depend_on_where_the_part_is_or_how_large(part, tmp_path):
    scale, shift = 1000.0, np.array([5e4, -2e4, 1e4])
    moved = Mesh.with_one_appearance(part.mesh.vertices * scale + shift, part.mesh.faces)
    points = surface_samples(part.mesh, 3000, seed=3) * 1.05
    here, there = part.scores(points), Case(tmp_path / "b", moved).scores(points * scale + shift)
    # clouds are kept in float32: 5e4 mm is rounded by 0.004 mm, 1e-7 diagonals of 3.5e4 mm
    for kind, value in here.items():
        if not kind[0].endswith("mm") and kind[0] != "hausdorff95":  # the others are in mm
            assert there[kind] == pytest.approx(value, rel=1e-4), kind
    worst = ("hausdorff95", "P1-dense")
    assert there[worst] == pytest.approx(scale * here[worst], rel=1e-4)


def test_a_failure_scores_the_worse_of_ball_and_box(part):
    extents, rng = np.full(3, SIDE), np.random.default_rng(0)
    ball, box = (
        part.scores(surface(extents, np.zeros(3), 4096, rng))
        for surface in (ball_surface, box_surface)
    )
    failed = part.failure()
    assert {row.status for row in part.rows} == {"failed"}
    # other samples of the same two surfaces: they agree to a few per cent at 256 points
    assert failed["emd", "P1-even"] == pytest.approx(
        max(ball["emd", "P1-even"], box["emd", "P1-even"]), rel=0.05
    )
    assert failed["fscore", "P1-dense"] <= min(ball["fscore", "P1-dense"], 0.9)


def test_a_cloud_with_no_point_to_score_is_a_failure(part):
    points = surface_samples(part.mesh)
    part.scores(points[is_on_cavity(points)])
    assert {row.status for row in part.rows} == {"failed"}


def test_too_few_visible_samples_name_the_knob(part, tmp_path):
    settings = replace(SETTINGS, points=4000)
    with pytest.raises(MetricError, match=r"raise evaluate\.dense"):
        measure_truth(part.part, tmp_path, settings=settings, seed=0)


def test_of_several_answers_the_mean_counts(part):
    accurate = surface_samples(part.mesh, 3000, seed=3)
    poor = surface_samples(part.mesh, 3000, seed=4) * 1.3
    alone = [part.scores(points) for points in (accurate, poor)]
    save_extra_clouds(part.folder / "cloud", [poor.astype(np.float32), accurate.astype(np.float32)])
    both = part.scores(accurate)
    dense = ("chamfer", "fscore", "within_0.5mm", "within_1mm", "covered_1mm", "hausdorff95")
    for kind in [("emd", "P1-even"), *((metric, "P1-dense") for metric in dense)]:
        expected = (2 * alone[0][kind] + alone[1][kind]) / 3
        assert both[kind] == pytest.approx(expected, rel=1e-6), kind
    assert both["emd", "P1-full"] == alone[0]["emd", "P1-full"]


def test_of_several_answers_the_truth_is_reduced_once(part, monkeypatch):
    reduced = []

    def counting(points, *arguments, **options):
        reduced.append(len(points))
        return sampling(points, *arguments, **options)

    sampling = fpsample.bucket_fps_kdline_sampling
    clouds = [surface_samples(part.mesh, 3000, seed=seed).astype(np.float32) for seed in (3, 4, 5)]
    save_extra_clouds(part.folder / "cloud", clouds[1:])
    monkeypatch.setattr(fpsample, "bucket_fps_kdline_sampling", counting)
    part.scores(clouds[0])
    # the visible truth and all of it, three clouds, and all of the first
    assert len(reduced) == 6


def test_an_answer_without_a_point_counts_as_a_failure(part):
    points, failed = surface_samples(part.mesh, 3000, seed=3), part.failure()
    alone = part.scores(points)
    save_extra_clouds(part.folder / "cloud", [np.zeros((0, 3), np.float32)])
    both = part.scores(points)
    for kind in (("emd", "P1-even"), ("fscore", "P1-dense")):
        assert both[kind] == pytest.approx((alone[kind] + failed[kind]) / 2, rel=1e-6)
    assert both["emd", "P1-iid"] == alone["emd", "P1-iid"]
    assert {row.status for row in part.rows} == {"ok"}
