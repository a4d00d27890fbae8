"""What the page's viewer shows: evenly spread points of each cloud, in about ten bytes a point.

Positions are 16-bit steps of a cube round the part, `SPAN` diagonals wide.  Distances are 8-bit
roots: 255 is `WORST` diagonals and more, 0 none.  Confidence is in 255ths.  A view is its number
plus one, 0 is unknown.  What is the same at every point of a cloud is left out: it says nothing.
"""

import base64
from dataclasses import dataclass

import fpsample
import numpy as np
from jaxtyping import Float, Float32, Int64, UInt8

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.part import Mesh, Part, load_mesh
from industnerf.artifacts.truth import Truth
from industnerf.report.gather import Study
from industnerf.report.pictures import deviation, missed_by
from industnerf.seeds import generator

POINTS = 6000  # of each cloud
CAP = 65536  # a denser cloud is first cut to this by chance, as for its score
SPAN = 3.0  # diagonals
WORST = 0.05  # diagonals
DISC = 1.4  # diameter of a disc, in mean distances of the truth's points


@dataclass(frozen=True)
class Scene:
    """One part in the viewer; `clouds` holds what `viewer.js` decodes, by method."""

    part: Part
    facts: dict[str, float]
    clouds: dict[str, dict]


def scene(study: Study, part: Part) -> Scene:
    """The truth and every method's cloud of `part`, or why there is none.

    Raises BadArtifact if a file is torn.
    """
    truth = Truth.load(study.folders.truth / part.part_id)
    surface = load_mesh(study.folders.parts / part.part_id)
    centre = (truth.points_mm.min(axis=0) + truth.points_mm.max(axis=0)) / 2
    box = Box(centre.astype(np.float64), part.diagonal_mm)
    few = _evenly(truth.points_mm, study.seed, part.part_id)
    shown = truth.points_mm[few]
    clouds = {"truth": _truth(truth, few, box)}
    for method in study.methods:
        folder = study.folders.clouds / method / part.part_id
        if folder.is_dir():
            clouds[method] = _cloud(Cloud.load(folder), surface, shown, box, study.seed)
        else:
            why = study.failures.get(method, {}).get(part.part_id, "it made no cloud")
            clouds[method] = {"failed": why, "count": 0, "says": "", "arrays": {}}
    facts = {
        "diagonal_mm": part.diagonal_mm,
        "span": SPAN,
        "worst_mm": WORST * part.diagonal_mm,
        "disc": DISC * float(np.sqrt(part.area_mm2 / len(shown))) / part.diagonal_mm,
    }
    return Scene(part, facts, clouds)


@dataclass(frozen=True)
class Box:
    """The cube that positions are steps of."""

    centre_mm: Float[np.ndarray, "3"]
    diagonal_mm: float

    def steps(self, points_mm: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Positions in [0, 65535], or beyond for points outside."""
        return 65535 * ((points_mm - self.centre_mm) / (SPAN * self.diagonal_mm) + 0.5)

    def roots(self, distances_mm: Float[np.ndarray, "n"]) -> UInt8[np.ndarray, "n"]:
        """Distances as roots in 255ths."""
        share = np.clip(distances_mm / (WORST * self.diagonal_mm), 0, 1)
        return np.rint(255 * np.sqrt(share)).astype(np.uint8)


def _truth(truth: Truth, few: np.ndarray, box: Box) -> dict:
    arrays = {
        "place": np.rint(box.steps(truth.points_mm[few])).astype(np.uint16),
        "visible": truth.visible[few].astype(np.uint8),
    }
    says = f"{len(few)} of {len(truth.points_mm)} samples of the true surface"
    return {"count": len(few), "says": says, "arrays": _text(arrays)}


def _cloud(cloud: Cloud, surface: Mesh, shown: np.ndarray, box: Box, seed: int) -> dict:
    worst = WORST * box.diagonal_mm
    few = _evenly(cloud.points_mm, seed, cloud.part_id)
    steps = np.rint(box.steps(cloud.points_mm[few]))
    inside = ((steps >= 0) & (steps <= 65535)).all(axis=1)
    few, points = few[inside], cloud.points_mm[few[inside]]
    arrays = {
        "place": steps[inside].astype(np.uint16),
        "error": box.roots(deviation(points, surface)),
        "missed": box.roots(missed_by(shown, cloud.points_mm, worst)),
    } | _said(cloud, few)
    says = f"{len(few)} of {len(cloud.points_mm)} points"
    outside = len(inside) - len(few)
    if outside:
        says += f"; {outside} more lie outside the picture"
    return {"count": len(few), "says": says, "arrays": _text(arrays)}


def _said(cloud: Cloud, few: np.ndarray) -> dict[str, np.ndarray]:
    """What the method says of the points `few`, if it does not say the same of all."""
    said = {
        "confidence": np.rint(255 * np.clip(cloud.confidence, 0, 1)).astype(np.uint8),
        "view": (cloud.view + 1).astype(np.uint16),
        "colour": cloud.colours,
    }
    telling = {name: values for name, values in said.items() if (values != values[:1]).any()}
    return {name: values[few] for name, values in telling.items()}


def _evenly(
    points_mm: Float32[np.ndarray, "n 3"], seed: int, part_id: str
) -> Int64[np.ndarray, "m"]:
    """Which points are shown, in ascending order: the farthest of at most CAP."""
    kept = np.arange(len(points_mm))
    if len(kept) > CAP:
        kept = generator(seed, "viewer", part_id).choice(kept, CAP, replace=False)
    if len(kept) > POINTS:
        centred = points_mm[kept] - points_mm[kept].mean(axis=0)  # fpsample computes in float32
        kept = kept[fpsample.bucket_fps_kdline_sampling(centred, POINTS, h=7, start_idx=0)]
    return np.unique(kept)  # fpsample repeats itself where points coincide


def _text(arrays: dict[str, np.ndarray]) -> dict[str, str]:
    """Little-endian bytes in base64."""
    return {
        name: base64.b64encode(values.astype(values.dtype.newbyteorder("<")).tobytes()).decode()
        for name, values in arrays.items()
    }
