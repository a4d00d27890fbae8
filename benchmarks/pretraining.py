"""How much do the networks gain from more procedural solids, and from more steps on them?

OMP_NUM_THREADS=1 python benchmarks/pretraining.py DATA [--methods ...] [--solids 100 1000 5000]
    [--steps 2000 8000] [--views 3]
python benchmarks/pretraining.py --draw benchmarks/results.md docs/reference/pretraining.png

DATA is the folder `data` of a finished run, of which `parts`, `views`, `truth`, `split.json` and
`procedural` are read.  Each network is pretrained on the first so many solids for so many steps,
without any part, and then reconstructs the dev parts.  `val loss` is that of the best weights on
solids that were held out.  EMD is P1-even by params.yaml, the mean over the first `--views` views
of networks that see one at a time.  Every row is one process on one core.  `--draw` draws the rows
that stand in a document.
"""

import argparse
import multiprocessing
from collections import defaultdict
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from itertools import product
from pathlib import Path
from statistics import fmean
from tempfile import TemporaryDirectory
from time import process_time

from matplotlib.ticker import ScalarFormatter
from nets import NETS, Job, mean_emd

from industnerf.artifacts.split import load_split
from industnerf.config import load_params
from industnerf.learning.procedural_shapes import load_procedural_shapes
from industnerf.learning.training_shape import Prior
from industnerf.methods import load_method
from industnerf.report.figures.figure_style import encode_png, new_figure
from industnerf.report.tables.formats import markdown_table
from industnerf.stage import read_index

COLUMNS = ("method", "solids", "steps", "minutes", "val loss", "EMD (dev)")


def run(data: Path, views: int | None, name: str, num_solids: int, steps: int) -> list[str]:
    """One row of COLUMNS."""
    settings = getattr(load_params().method, name)
    if views and hasattr(settings, "eval_views"):
        settings = replace(settings, eval_views=views)
    training = replace(settings.pretraining, max_steps=steps, val_interval=max(1, steps // 8))
    settings = replace(settings, training=training)
    folder = data / "procedural"
    solids = load_procedural_shapes(folder, list(read_index(folder)))
    shapes = [solid for solid in solids if solid.resembles is None]  # as the stage pretrain does
    start = process_time()
    with TemporaryDirectory() as scratch:
        prior = Prior(shapes[:num_solids])
        state = load_method(name).fit((), settings, 0, Path(scratch), prior)
    minutes = (process_time() - start) / 60
    dev = [part for part, one in load_split(data / "split.json").items() if one.split == "dev"]
    emd = fmean(mean_emd(Job(data, name, 0, 1, settings), state, part) for part in dev)
    loss = min(state.val_history.loss) if state.val_history else float("nan")
    return [
        *(name, str(min(num_solids, len(shapes))), str(steps)),
        *(f"{minutes:.1f}", f"{loss:.4g}", f"{emd:.4f}"),
    ]


def steps_of_several_sizes(points: list[tuple[str, int, int, float, float]]) -> list[int]:
    """The numbers of steps that were run with more than one number of solids."""
    sizes = defaultdict(set)
    for _, solids, steps, _, _ in points:
        sizes[steps].add(solids)
    return sorted(steps for steps, some in sizes.items() if len(some) > 1)


def draw(document: Path, image: Path) -> None:
    """EMD against solids, after equal steps, and against minutes, with equal solids."""
    cells = [line.strip("| \n").split(" | ") for line in document.read_text().splitlines()]
    rows = [row for row in cells if len(row) == len(COLUMNS) and row[0] in NETS]
    # A rate that was given up, and statistics of batch norm that do not compare with the others'.
    rows = [row for row in rows if "at 1e-3" not in row[2] and "1500, kept" not in row[2]]
    points = [
        (name, int(solids), int(steps.split(",")[0]), float(minutes.split(",")[0]), float(value))
        for name, solids, steps, minutes, _, value in rows
    ]
    figure = new_figure(7, 2.8)
    by_solids, by_minutes = figure.subplots(1, 2, sharey=True)
    for color, name in enumerate(NETS):
        own = [point for point in points if point[0] == name]
        for style, steps in zip(("--", "-"), steps_of_several_sizes(own), strict=False):
            line = sorted((solids, value) for _, solids, many, _, value in own if many == steps)
            label = name if style == "--" else None
            by_solids.plot(
                *zip(*line, strict=True), style, marker="o", color=f"C{color}", label=label
            )
        curve = sorted((minutes, value) for _, solids, _, minutes, value in own if solids == 5000)
        by_minutes.plot(*zip(*curve, strict=True), marker="o", color=f"C{color}")
    by_solids.set(xscale="log", xlabel="solids (dashed: 1500 steps, full: 8000 or 12000)")
    by_solids.set_ylabel("EMD, dev parts")
    by_minutes.set(xscale="log", xlabel="minutes of one core, 5000 solids")
    for axis in (by_solids, by_minutes):
        axis.xaxis.set_major_formatter(ScalarFormatter())
    by_solids.legend(fontsize=7)
    image.write_bytes(encode_png(figure))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path, nargs="?")
    parser.add_argument("--draw", nargs=2, type=Path, metavar=("DOCUMENT", "IMAGE"))
    parser.add_argument("--methods", nargs="+", default=NETS)
    parser.add_argument("--solids", nargs="+", type=int, default=[100, 1000, 5000])
    parser.add_argument("--steps", nargs="+", type=int, default=[2000, 8000])
    parser.add_argument("--views", type=int)
    arguments = parser.parse_args()
    if arguments.draw:
        draw(*arguments.draw)
        return
    if arguments.data is None:
        parser.error("DATA or --draw is needed")
    print(markdown_table(COLUMNS, []), end="")
    for job in product(arguments.methods, arguments.solids, arguments.steps):
        with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            row = pool.submit(run, arguments.data, arguments.views, *job).result()
        print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
