"""Error maps of clouds: what is in the wrong place, and what is missing.

python benchmarks/error_map.py DATA METHOD PICTURE [--split dev]

DATA is the folder `data` of a finished run, of which `truth`, `clouds` and `split.json` are read.
Of each part two pictures: the cloud, colored by how far it is from the true surface, and the true
surface, by how far the cloud is.  Both are what is scored: points that some photograph could show.
The worst points are drawn last, so that they show through whatever is before them.  Parts come in
the order of their errors, the mean of both distances; the numbers are the two, % of the diagonal.
Printed are the colors of the points that are 3 % of the diagonal off or more, and of the rest: the
median of their darkest channels, of 255.
"""

import argparse
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float
from rich.console import Console
from rich.progress import track
from rich.table import Table

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.part import load_part
from industnerf.artifacts.split import load_split
from industnerf.artifacts.truth import Truth
from industnerf.config import load_params
from industnerf.geometry.thumbnail import viewing_axes
from industnerf.metrics.nearest_distances import (
    NearestDistances,
    distance_to_nearest,
    nearest_distances,
)
from industnerf.metrics.protocol import Evaluator
from industnerf.report.figures.figure_style import (
    add_colorbar,
    colorize,
    encode_png,
    new_figure,
    show_image,
)
from industnerf.seeds import generator

PARTS_PER_ROW = 4  # parts in a row, of two pictures each
IMAGE_PX = 160  # px
MAX_PERCENT = 4.0  # % of the diagonal: the last color
COLORS = "turbo"
OUTLIER_DISTANCE = 0.03  # diagonals
DOT_OFFSETS = np.array([(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)])


@dataclass(frozen=True)
class PartError:
    """What is scored of one part; lengths in diagonals."""

    part_id: str
    truth: Float[np.ndarray, "m 3"]
    cloud: Float[np.ndarray, "n 3"]
    distances: NearestDistances

    @property
    def means(self) -> tuple[float, float]:
        """Of the cloud's points, and of the truth's."""
        return self.distances.predicted_to_truth.mean(), self.distances.truth_to_predicted.mean()


def measure_error(data: Path, method: str, part_id: str) -> PartError:
    """How far cloud and truth are from each other, point by point."""
    params = load_params()
    truth_artifact = Truth.load(data / "truth" / part_id)
    evaluator = Evaluator(data / "parts" / part_id, truth_artifact, params.evaluate, params.seed)
    points = Cloud.load(data / "clouds" / method / part_id).points_mm
    sampled = evaluator.sample_prediction(points, generator(params.seed, "evaluate", part_id))
    truth = evaluator.truth
    cloud, truth = sampled.points[sampled.evaluated], truth.points[truth.evaluated]
    return PartError(part_id, truth, cloud, nearest_distances(truth, cloud))


def draw_points(points: Float[np.ndarray, "n 3"], error: Float[np.ndarray, "n"]) -> np.ndarray:
    """The points from where portraits look, in parallel projection, the worst on top."""
    right, up, _ = viewing_axes()
    flat = points @ np.stack([right, -up], axis=1)
    low, high = flat.min(axis=0), flat.max(axis=0)
    middle = (flat - (low + high) / 2) / (high - low).max() * 0.94 + 0.5
    order = np.argsort(error)
    pixels = np.full((IMAGE_PX, IMAGE_PX, 3), 255, np.uint8)
    places = np.clip((middle[order, None] * IMAGE_PX).astype(int) + DOT_OFFSETS, 0, IMAGE_PX - 1)
    pixels[places[..., 1], places[..., 0]] = colorize(100 * error[order], COLORS, MAX_PERCENT)[
        :, None
    ]
    return pixels


def color_statistics(data: Path, method: str, part_id: str) -> tuple[str, ...]:
    """Which share of a cloud's points is astray, and how dark these and the others are."""
    cloud = Cloud.load(data / "clouds" / method / part_id)
    part = load_part(data / "parts" / part_id)
    surface = Truth.load(data / "truth" / part_id).points_mm.astype(float)
    is_outlier = (
        distance_to_nearest(cloud.points_mm.astype(float), surface)
        >= OUTLIER_DISTANCE * part.diagonal_mm
    )
    darkness = cloud.colors.min(axis=1)
    medians = (
        f"{np.median(darkness[selected]):.0f}" if selected.any() else ""
        for selected in (is_outlier, ~is_outlier)
    )
    return part_id, f"{100 * is_outlier.mean():.1f}", *medians


def draw_error_map(errors: list[PartError]) -> bytes:
    """All parts, two pictures each, as a PNG."""
    rows = -(-len(errors) // PARTS_PER_ROW)
    fig = new_figure(10.4, 1.45 * rows)
    axes = fig.subplots(rows, 2 * PARTS_PER_ROW, squeeze=False)
    for axis in axes.flat:
        axis.set_axis_off()
    for error, (left, right) in zip(errors, axes.reshape(-1, 2), strict=False):
        show_error(
            left,
            error.cloud,
            error.distances.predicted_to_truth,
            error.part_id,
            100 * error.means[0],
        )
        show_error(
            right, error.truth, error.distances.truth_to_predicted, "missing", 100 * error.means[1]
        )
    add_colorbar(fig, axes, COLORS, MAX_PERCENT, "% of the diagonal")
    return encode_png(fig)


def show_error(axis: Any, points: np.ndarray, error: np.ndarray, title: str, mean: float) -> None:
    """One picture and what it is of."""
    show_image(axis, draw_points(points, error))
    axis.set_title(f"{title[:21]} {mean:.2f}", fontsize=5)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("data", type=Path)
    parser.add_argument("method")
    parser.add_argument("picture", type=Path)
    parser.add_argument("--split", default="dev")
    arguments = parser.parse_args()
    split = load_split(arguments.data / "split.json")
    part_ids = [
        part_id for part_id, assignment in split.items() if assignment.split == arguments.split
    ]
    measure = partial(measure_error, arguments.data, arguments.method)
    errors = [measure(part_id) for part_id in track(part_ids, arguments.method)]
    errors.sort(key=lambda error: -sum(error.means))
    arguments.picture.write_bytes(draw_error_map(errors))
    table = Table("part", "astray, %", "their color", "the others'")
    for error in errors:
        table.add_row(*color_statistics(arguments.data, arguments.method, error.part_id))
    Console().print(table)


if __name__ == "__main__":
    main()
