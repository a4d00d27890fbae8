"""Error maps of clouds: what is in the wrong place, and what is missing.

python benchmarks/error_map.py DATA METHOD PICTURE [--split dev]

DATA is the folder `data` of a finished run, of which `truth`, `clouds` and `split.json` are read.
Of each part two pictures: the cloud, coloured by how far it is from the true surface, and the true
surface, by how far the cloud is.  Both are what is scored: points that some photograph could show.
The worst points are drawn last, so that they show through whatever is before them.  Parts come in
the order of their errors, the mean of both distances; the numbers are the two, % of the diagonal.
Printed are the colours of the points that are 3 % of the diagonal off or more, and of the rest: the
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
from industnerf.geometry.portrait import viewing_axes
from industnerf.metrics.gaps import Gaps, between, nearest
from industnerf.metrics.protocol import Judge
from industnerf.report.plates import figure, legend, picture, png, tinted
from industnerf.seeds import generator

ACROSS = 4  # parts in a row, of two pictures each
SIDE = 160  # px
HIGHEST = 4.0  # % of the diagonal: the last colour
COLOURS = "turbo"
ASTRAY = 0.03  # diagonals
DOT = np.array([(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)])


@dataclass(frozen=True)
class Error:
    """What is scored of one part; lengths in diagonals."""

    part_id: str
    truth: Float[np.ndarray, "m 3"]
    cloud: Float[np.ndarray, "n 3"]
    gaps: Gaps

    @property
    def means(self) -> tuple[float, float]:
        """Of the cloud's points, and of the truth's."""
        return self.gaps.predicted.mean(), self.gaps.truth.mean()


def error_of(data: Path, method: str, part_id: str) -> Error:
    """How far cloud and truth are from each other, point by point."""
    params = load_params()
    known = Truth.load(data / "truth" / part_id)
    judge = Judge(data / "parts" / part_id, known, params.evaluate, params.seed)
    points = Cloud.load(data / "clouds" / method / part_id).points_mm
    shown, truth = judge.sampled(points, generator(params.seed, "evaluate", part_id)), judge.truth
    cloud, truth = shown.points[shown.kept], truth.points[truth.kept]
    return Error(part_id, truth, cloud, between(truth, cloud))


def drawn(points: Float[np.ndarray, "n 3"], error: Float[np.ndarray, "n"]) -> np.ndarray:
    """The points from where portraits look, in parallel projection, the worst on top."""
    right, up, _ = viewing_axes()
    flat = points @ np.stack([right, -up], axis=1)
    low, high = flat.min(axis=0), flat.max(axis=0)
    middle = (flat - (low + high) / 2) / (high - low).max() * 0.94 + 0.5
    order = np.argsort(error)
    pixels = np.full((SIDE, SIDE, 3), 255, np.uint8)
    places = np.clip((middle[order, None] * SIDE).astype(int) + DOT, 0, SIDE - 1)
    pixels[places[..., 1], places[..., 0]] = tinted(100 * error[order], COLOURS, HIGHEST)[:, None]
    return pixels


def colours_of(data: Path, method: str, part_id: str) -> tuple[str, ...]:
    """Which share of a cloud's points is astray, and how dark these and the others are."""
    cloud, part = (
        Cloud.load(data / "clouds" / method / part_id),
        load_part(data / "parts" / part_id),
    )
    surface = Truth.load(data / "truth" / part_id).points_mm.astype(float)
    off = nearest(cloud.points_mm.astype(float), surface) >= ASTRAY * part.diagonal_mm
    dark = cloud.colours.min(axis=1)
    medians = (f"{np.median(dark[those]):.0f}" if those.any() else "" for those in (off, ~off))
    return part_id, f"{100 * off.mean():.1f}", *medians


def plate(errors: list[Error]) -> bytes:
    """All parts, two pictures each, as a PNG."""
    rows = -(-len(errors) // ACROSS)
    sheet = figure(10.4, 1.45 * rows)
    axes = sheet.subplots(rows, 2 * ACROSS, squeeze=False)
    for axis in axes.flat:
        axis.set_axis_off()
    for error, (left, right) in zip(errors, axes.reshape(-1, 2), strict=False):
        show(left, error.cloud, error.gaps.predicted, error.part_id, 100 * error.means[0])
        show(right, error.truth, error.gaps.truth, "missing", 100 * error.means[1])
    legend(sheet, axes, COLOURS, HIGHEST, "% of the diagonal")
    return png(sheet)


def show(axis: Any, points: np.ndarray, error: np.ndarray, what: str, mean: float) -> None:
    """One picture and what it is of."""
    picture(axis, drawn(points, error))
    axis.set_title(f"{what[:21]} {mean:.2f}", fontsize=5)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("data", type=Path)
    parser.add_argument("method")
    parser.add_argument("picture", type=Path)
    parser.add_argument("--split", default="dev")
    asked = parser.parse_args()
    split = load_split(asked.data / "split.json")
    chosen = [part_id for part_id, place in split.items() if place.split == asked.split]
    measure = partial(error_of, asked.data, asked.method)
    errors = [measure(part_id) for part_id in track(chosen, asked.method)]
    errors.sort(key=lambda error: -sum(error.means))
    asked.picture.write_bytes(plate(errors))
    table = Table("part", "astray, %", "their colour", "the others'")
    for error in errors:
        table.add_row(*colours_of(asked.data, asked.method, error.part_id))
    Console().print(table)


if __name__ == "__main__":
    main()
