"""A small study on disk: two balls, reconstructed well, badly, and not at all."""

from pathlib import Path

import numpy as np
import trimesh

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.part import Mesh, Part, save_part
from industnerf.artifacts.scores import PartScore, Score
from industnerf.artifacts.split import Place
from industnerf.artifacts.truth import Truth
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.methods import load_method
from industnerf.report.gather import Folders, Study
from industnerf.report.given import Views
from tests.samples import unit_part

RADIUS = 10.0  # mm
EDGE = 2 * RADIUS
DIAGONAL = EDGE * np.sqrt(3)
CENTRE = np.array([100.0, -50.0, 7.0])  # mm
FAR = 0.2  # mm that the hull's cloud stands off the surface
PARTS = ("near-ball", "far-ball")
EMD = {"hull": 0.02, "oracle": 0.01, "box": 0.2}
FLOOR = 0.01
BROKEN = "no silhouette <seen>"


def part(name: str) -> Part:
    """A ball."""
    return unit_part(
        name,
        "balls",
        designation=f"A {name}",
        extents_mm=(EDGE, EDGE, EDGE),
        area_mm2=4 * np.pi * RADIUS**2,
        strata=("symmetric",),
    )


def points(count: int, radius: float) -> np.ndarray:
    """Points of a sphere about CENTRE."""
    return (CENTRE + radius * fibonacci_sphere(count)).astype(np.float32)


def surface(true: np.ndarray) -> Mesh:
    """The polyhedron whose corners are the points `true`."""
    hull = trimesh.convex.convex_hull(true.astype(np.float64))
    return Mesh.plain(hull.vertices, hull.faces.astype(np.int32))


def cloud(name: str, where: np.ndarray, *, telling: bool) -> Cloud:
    """A cloud whose points differ in all that is said of them, or in nothing."""
    count = len(where)
    share = np.linspace(0, 1, count) if telling else np.ones(count)
    return Cloud(
        name,
        where,
        np.tile((200 * share).astype(np.uint8)[:, None], (1, 3)),
        share.astype(np.float32),
        (np.arange(count) % 5 if telling else np.full(count, -1)).astype(np.int16),
        0,
        0,
    )


def lay_out(folder: Path, name: str, count: int = 2000) -> None:
    """Truth and clouds of one part; the box made none.  Near-ball is hidden towards +x."""
    true = points(count, RADIUS)
    visible = (true[:, 0] < CENTRE[0]) if name == "near-ball" else np.ones(count, bool)
    clouds = {"hull": (RADIUS + FAR, True), "oracle": (RADIUS, False)}
    (folder / "truth" / name).mkdir(parents=True)
    Truth(true, visible, {}).save(folder / "truth" / name)
    (folder / "parts" / name).mkdir(parents=True)
    save_part(folder / "parts" / name, part(name), surface(true))
    for method, (radius, telling) in clouds.items():
        (folder / method / name).mkdir(parents=True)
        cloud(name, points(count, radius), telling=telling).save(folder / method / name)


def scores(name: str) -> list[PartScore]:
    """EMD of every method, and what the hull says of its confidence."""
    found = [
        PartScore(
            name,
            method,
            Score("emd", protocol, value, FLOOR, "diagonal", "failed" if method == "box" else "ok"),
        )
        for method, value in EMD.items()
        for protocol in ("P1-even", "P1-iid", "P1-full")
    ]
    more = {
        "within_0.5mm": (0.75, "share", "P1-dense"),
        "hausdorff95": (0.31, "mm", "P1-dense"),
        "confidence_spearman": (-0.4, "1", "P1-near"),
        "confidence_ause": (0.1, "1", "P1-near"),
        "confidence_ause_chance": (0.4, "1", "P1-near"),
        "error_left_10": (0.9, "1", "P1-near"),
    }
    for metric, (value, unit, protocol) in more.items():
        found.append(PartScore(name, "hull", Score(metric, protocol, value, 0.0, unit, "ok")))
    return found


def study(folder: Path) -> Study:
    """The study whose files `lay_out` wrote into `folder`."""
    nowhere = folder / "nowhere"
    return Study(
        preset="gallery",
        seed=0,
        views=12,
        methods={name: load_method(name) for name in EMD},
        parts={name: part(name) for name in PARTS},
        places={name: Place("test", None) for name in PARTS},
        scores=[score for name in PARTS for score in scores(name)],
        failures={
            "box": dict.fromkeys(PARTS, BROKEN),
            "parts": {"torn-part": "torn.step: no solid"},
        },
        remarks={},
        training=dict.fromkeys(EMD, (0, 0)),
        lessons={},
        seen_by_training=dict.fromkeys(PARTS, 0.9),
        seen_by_rig=dict.fromkeys(PARTS, 1.0),
        folders=Folders(
            nowhere, folder / "parts", nowhere, nowhere, folder / "truth", nowhere, folder, nowhere
        ),
        given=dict.fromkeys(EMD, Views(12)),
        seeds_sd={},
        empty_answers={},
    )
