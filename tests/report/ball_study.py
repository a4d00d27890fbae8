"""A small study on disk: two balls, reconstructed well, badly, and not at all."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import trimesh

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.part import Mesh, Part, save_part
from industnerf.artifacts.scores import PartScore, Score
from industnerf.artifacts.split import SplitAssignment
from industnerf.artifacts.truth import Truth
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.methods import load_method
from industnerf.report.study import InputViews, Study, StudyFolders
from tests.samples import unit_part

RADIUS_MM = 10.0  # mm
EDGE_MM = 2 * RADIUS_MM
DIAGONAL_MM = EDGE_MM * np.sqrt(3)
CENTER = np.array([100.0, -50.0, 7.0])  # mm
HULL_OFFSET_MM = 0.2  # mm that the hull's cloud stands off the surface
PARTS = ("near-ball", "far-ball")
EMD = {"hull": 0.02, "oracle": 0.01, "box": 0.2}
FLOOR = 0.01
FAILURE = "no silhouette <seen>"


def part(name: str) -> Part:
    """A ball."""
    return unit_part(
        name,
        "balls",
        designation=f"A {name}",
        extents_mm=(EDGE_MM, EDGE_MM, EDGE_MM),
        area_mm2=4 * np.pi * RADIUS_MM**2,
        strata=("symmetric",),
    )


def points(count: int, radius: float) -> np.ndarray:
    """Points of a sphere about CENTER."""
    return (CENTER + radius * fibonacci_sphere(count)).astype(np.float32)


def surface(points_mm: np.ndarray) -> Mesh:
    """The convex polyhedron whose corners are `points_mm`."""
    hull = trimesh.convex.convex_hull(points_mm.astype(np.float64))
    return Mesh.with_one_appearance(hull.vertices, hull.faces.astype(np.int32))


def cloud(name: str, points_mm: np.ndarray, *, is_varied: bool) -> Cloud:
    """A cloud whose points differ in all that is said of them, or in nothing."""
    count = len(points_mm)
    share = np.linspace(0, 1, count) if is_varied else np.ones(count)
    return Cloud(
        name,
        points_mm,
        np.tile((200 * share).astype(np.uint8)[:, None], (1, 3)),
        share.astype(np.float32),
        (np.arange(count) % 5 if is_varied else np.full(count, -1)).astype(np.int16),
        0,
        0,
    )


def write_part(folder: Path, name: str, count: int = 2000) -> None:
    """Truth and clouds of one part; the box made none.  Near-ball is hidden towards +x."""
    surface_points = points(count, RADIUS_MM)
    visible = (surface_points[:, 0] < CENTER[0]) if name == "near-ball" else np.ones(count, bool)
    clouds = {"hull": (RADIUS_MM + HULL_OFFSET_MM, True), "oracle": (RADIUS_MM, False)}
    (folder / "truth" / name).mkdir(parents=True)
    Truth(surface_points, visible, {}).save(folder / "truth" / name)
    (folder / "parts" / name).mkdir(parents=True)
    save_part(folder / "parts" / name, part(name), surface(surface_points))
    for method, (radius, is_varied) in clouds.items():
        (folder / method / name).mkdir(parents=True)
        cloud(name, points(count, radius), is_varied=is_varied).save(folder / method / name)


def scores(name: str) -> list[PartScore]:
    """EMD of every method, and what the hull says of its confidence."""
    rows = [
        PartScore(
            name,
            method,
            Score("emd", protocol, value, FLOOR, "diagonal", "failed" if method == "box" else "ok"),
        )
        for method, value in EMD.items()
        for protocol in ("P1-even", "P1-iid", "P1-full")
    ]
    hull_metrics = {
        "within_0.5mm": (0.75, "share", "P1-dense"),
        "hausdorff95": (0.31, "mm", "P1-dense"),
        "confidence_spearman": (-0.4, "1", "P1-near"),
        "confidence_ause": (0.1, "1", "P1-near"),
        "confidence_ause_chance": (0.4, "1", "P1-near"),
        "error_left_10": (0.9, "1", "P1-near"),
    }
    for metric, (value, unit, protocol) in hull_metrics.items():
        rows.append(PartScore(name, "hull", Score(metric, protocol, value, 0.0, unit, "ok")))
    return rows


def study(folder: Path) -> Study:
    """The study whose files `write_part` wrote into `folder`."""
    nowhere = folder / "nowhere"
    return Study(
        preset="gallery",
        seed=0,
        num_train_views=12,
        methods={name: load_method(name) for name in EMD},
        parts={name: part(name) for name in PARTS},
        assignments={name: SplitAssignment("test", None) for name in PARTS},
        scores=[score for name in PARTS for score in scores(name)],
        failures={
            "box": dict.fromkeys(PARTS, FAILURE),
            "parts": {"torn-part": "torn.step: no solid"},
        },
        input_warnings={},
        parameters_and_steps=dict.fromkeys(EMD, (0, 0)),
        training_summaries={},
        train_visible_share=dict.fromkeys(PARTS, 0.9),
        rig_visible_share=dict.fromkeys(PARTS, 1.0),
        folders=replace(
            StudyFolders.all_at(nowhere),
            parts=folder / "parts",
            truth=folder / "truth",
            clouds=folder,
        ),
        input_views=dict.fromkeys(EMD, InputViews(12)),
        seeds_sd={},
        empty_predictions={},
    )
