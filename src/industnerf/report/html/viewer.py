"""The 3-D viewer of the page: evenly spread points of each cloud, in about ten bytes a point.

Positions are 14-bit steps of a cube around the part, `SPAN` diagonals wide. Distances are 8-bit
square roots: 255 is `MAX_ERROR` diagonals or more. Confidence is in 255ths. A view is its number
plus one; 0 is unknown. An attribute that is the same at every point of a cloud is left out.
Points are in Z-order and positions are differences, so that zlib finds small numbers.
templates/viewer.html.j2 writes the controls and the data, web/viewer.js draws them.
"""

import base64
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import fpsample
import numpy as np
from jaxtyping import Float, Float32, Int64, UInt8

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.part import Mesh, Part, load_mesh
from industnerf.artifacts.truth import Truth
from industnerf.report.figures.contact_sheet import (
    cloud_to_surface_distances,
    truth_to_cloud_distances,
)
from industnerf.report.study import Study
from industnerf.report.tables.formats import format_significant
from industnerf.report.tables.scores import Scores
from industnerf.seeds import generator

SHOWN_POINTS = 4500  # of each cloud
MAX_POINTS = 65536  # a denser cloud is first cut to this by chance, as for its score
SPAN = 3.0  # diagonals
POSITION_BITS = 14
STEPS = 2**POSITION_BITS - 1  # of positions
MAX_ERROR = 0.05  # diagonals
DISC_SPACINGS = 1.4  # diameter of a disc, in mean distances of the truth's points
COLORINGS = {
    "error": "error, mm",
    "confidence": "confidence",
    "view": "contributing view",
    "photo": "photo color",
}
LIMITS, DEFAULT_LIMIT = (0.005, 0.01, 0.02, 0.05), 0.02  # ends of the color scale, in diagonals
COLOR_MAPS = {"error": "turbo", "confidence": "viridis"}  # matplotlib's names
NOTE = (
    "Both sides share one camera. Error is the distance to the true surface. On the side of the "
    "truth it is the distance to the nearest point of the other side's cloud: what that one "
    f"misses. Points are spread evenly, up to {SHOWN_POINTS} a cloud. Of several predictions of a "
    "network the first that has points is shown; its EMD is the mean over all of them."
)


@dataclass(frozen=True)
class ViewerScene:
    """One part in the viewer; `clouds` holds what viewer.js decodes, by method."""

    part: Part
    facts: dict[str, float | str]
    clouds: dict[str, dict]


def pack_scene(study: Study, part: Part) -> ViewerScene:
    """The true surface and every method's cloud of `part`, or why there is none.

    Raises BadArtifact if a file is torn.
    """
    truth = Truth.load(study.folders.truth / part.part_id)
    surface = load_mesh(study.folders.parts / part.part_id)
    center = (truth.points_mm.min(axis=0) + truth.points_mm.max(axis=0)) / 2
    box = Box(center.astype(np.float64), part.diagonal_mm)
    indices = _even_subset(truth.points_mm, study.seed, part.part_id)
    indices = indices[z_order(np.rint(box.quantize_positions(truth.points_mm[indices])))]
    truth_points = truth.points_mm[indices]
    clouds = {"truth": _pack_truth(truth, indices, box)}
    for method in study.methods:
        folder = study.folders.clouds / method / part.part_id
        if folder.is_dir():
            clouds[method] = _pack_cloud(Cloud.load(folder), surface, truth_points, box, study.seed)
        else:
            reason = study.failures.get(method, {}).get(part.part_id, "it made no cloud")
            clouds[method] = {"failed": reason, "count": 0, "caption": "", "arrays": {}}
    facts = {
        "unit": "mm",
        "diagonal_mm": part.diagonal_mm,
        "span": SPAN,
        "max_error_mm": MAX_ERROR * part.diagonal_mm,
        "disc_diameter": DISC_SPACINGS
        * float(np.sqrt(part.area_mm2 / len(truth_points)))
        / part.diagonal_mm,
    }
    return ViewerScene(part, facts, clouds)


@dataclass(frozen=True)
class Box:
    """The cube that positions are steps of."""

    center_mm: Float[np.ndarray, "3"]
    diagonal_mm: float

    def quantize_positions(self, points_mm: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Positions in [0, STEPS], or beyond for points outside."""
        return STEPS * ((points_mm - self.center_mm) / (SPAN * self.diagonal_mm) + 0.5)

    def quantize_distances(self, distances_mm: Float[np.ndarray, "n"]) -> UInt8[np.ndarray, "n"]:
        """Distances as roots in 255ths."""
        share = np.clip(distances_mm / (MAX_ERROR * self.diagonal_mm), 0, 1)
        return np.rint(255 * np.sqrt(share)).astype(np.uint8)


def _pack_truth(truth: Truth, indices: np.ndarray, box: Box) -> dict:
    arrays = {
        "positions": np.rint(box.quantize_positions(truth.points_mm[indices])).astype(np.uint16),
        "visible": truth.visible[indices].astype(np.uint8),
    }
    caption = f"{len(indices)} of {len(truth.points_mm)} samples of the true surface"
    return {"count": len(indices), "caption": caption, "arrays": to_base64(arrays)}


def _pack_cloud(cloud: Cloud, surface: Mesh, truth_points: np.ndarray, box: Box, seed: int) -> dict:
    max_error_mm = MAX_ERROR * box.diagonal_mm
    indices = _even_subset(cloud.points_mm, seed, cloud.part_id)
    quantized = np.rint(box.quantize_positions(cloud.points_mm[indices]))
    inside = np.flatnonzero(((quantized >= 0) & (quantized <= STEPS)).all(axis=1))
    num_outside = len(quantized) - len(inside)
    inside = inside[z_order(quantized[inside])]
    indices, points = indices[inside], cloud.points_mm[indices[inside]]
    arrays = {
        "positions": quantized[inside].astype(np.uint16),
        "error": box.quantize_distances(cloud_to_surface_distances(points, surface)),
        "missed": box.quantize_distances(
            truth_to_cloud_distances(truth_points, cloud.points_mm, max_error_mm)
        ),
    } | _point_attributes(cloud, indices)
    caption = f"{len(indices)} of {len(cloud.points_mm)} points"
    if num_outside:
        caption += f"; {num_outside} more lie outside the viewer"
    return {"count": len(indices), "caption": caption, "arrays": to_base64(arrays)}


def _point_attributes(cloud: Cloud, indices: np.ndarray) -> dict[str, np.ndarray]:
    """Attributes of the points at `indices` that differ between the points of the cloud."""
    attributes = {
        "confidence": np.rint(255 * np.clip(cloud.confidence, 0, 1)).astype(np.uint8),
        "view": (cloud.view + 1).astype(np.uint16),
        "color": cloud.colors,
    }
    varying = {name: values for name, values in attributes.items() if (values != values[:1]).any()}
    return {name: values[indices] for name, values in varying.items()}


def _even_subset(
    points_mm: Float32[np.ndarray, "n 3"], seed: int, part_id: str
) -> Int64[np.ndarray, "m"]:
    """Indices of the points to show, ascending: farthest points of at most MAX_POINTS."""
    indices = np.arange(len(points_mm))
    if len(indices) > MAX_POINTS:
        indices = generator(seed, "viewer", part_id).choice(indices, MAX_POINTS, replace=False)
    if len(indices) > SHOWN_POINTS:
        centered = points_mm[indices] - points_mm[indices].mean(axis=0)  # fpsample has float32
        farthest = fpsample.bucket_fps_kdline_sampling(centered, SHOWN_POINTS, h=7, start_idx=0)
        indices = indices[farthest]
    return np.unique(indices)  # fpsample repeats itself where points coincide


def z_order(steps: Float[np.ndarray, "n 3"]) -> Int64[np.ndarray, "n"]:
    """Indices that sort positions of POSITION_BITS along a Z-order curve."""
    bits = np.unpackbits(np.ascontiguousarray(steps.T).astype(">u2").view(np.uint8), axis=1)
    interleaved = bits.reshape(3, len(steps), 16).transpose(1, 2, 0).reshape(len(steps), 48)
    codes = np.zeros(len(steps), np.uint64)
    for column in interleaved.T:
        codes = codes << np.uint64(1) | column
    return np.argsort(codes, kind="stable")


def to_base64(arrays: dict[str, np.ndarray]) -> dict[str, str]:
    """Each array as viewer.js decodes it, zlib-compressed, in base64.

    Positions are differences along each axis, modulo 2**16. Of 16-bit numbers all low bytes come
    first, then all high ones.
    """
    texts = {}
    for name, values in arrays.items():
        if name == "positions":
            values = np.diff(values.T, axis=1, prepend=np.uint16(0))
        planes = values.ravel().view(np.uint8).reshape(-1, values.dtype.itemsize).T
        texts[name] = base64.b64encode(zlib.compress(planes.tobytes(), 9)).decode()
    return texts


def viewer_context(study: Study, scores: Scores, scenes: Sequence[ViewerScene]) -> dict[str, Any]:
    """What templates/viewer.html.j2 shows; `scenes` may be empty."""
    return {
        "names": ["truth", *study.methods],
        "colorings": COLORINGS,
        "limits": LIMITS,
        "default_limit": DEFAULT_LIMIT,
        "note": NOTE,
        "is_single": False,
        "color_maps": color_maps_base64(COLOR_MAPS) if scenes else {},
        "scenes": [
            {
                "part_id": scene.part.part_id,
                "designation": scene.part.designation,
                "data": _scene_data(scores, scene),
            }
            for scene in scenes
        ],
    }


def _scene_data(scores: Scores, scene: ViewerScene) -> dict[str, Any]:
    packed = {
        name: cloud | {"caption": _cloud_caption(scores, scene.part, name, cloud["caption"])}
        for name, cloud in scene.clouds.items()
    }
    return scene.facts | {"packed": packed}


def _cloud_caption(scores: Scores, part: Part, name: str, caption: str) -> str:
    """EMD of the cloud in diagonals, mm and floors, before what is shown of it."""
    score = scores.get(part.part_id, name)
    if score is None:
        return caption
    emd = f"EMD {score.value:.4f} = {format_significant(score.value * part.diagonal_mm)} mm"
    ratio = f" ({score.value / score.floor:.2f} x floor)" if score.floor else ""
    return f"{emd}{ratio}; {caption}"


def color_maps_base64(names: dict[str, str]) -> dict[str, str]:
    """The 256 colors of each of matplotlib's color maps, three bytes each, base64."""
    return {
        key: base64.b64encode(color_map(name).tobytes()).decode() for key, name in names.items()
    }


def color_map(name: str) -> UInt8[np.ndarray, "256 3"]:
    """The colors of one of matplotlib's color maps."""
    from matplotlib import colormaps

    return np.ascontiguousarray(colormaps[name](np.arange(256), bytes=True)[:, :3])
