"""How much do the networks gain from more procedural solids, and from more steps on them?

OMP_NUM_THREADS=1 python benchmarks/pretraining.py DATA [--methods ...] [--solids 100 1000 5000]
    [--steps 2000 8000] [--views 3]

DATA is the folder `data` of a finished run, of which `parts`, `views`, `truth`, `split.json` and
`procedural` are read.  Each network is pretrained on the first so many solids for so many steps,
without any part, and then reconstructs the dev parts.  `val loss` is that of the best weights on
solids that were held out.  EMD is P1-even by params.yaml, the mean over the first `--views` views
of networks that see one at a time.  Every row is one process on one core.
"""

import argparse
import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from itertools import product
from pathlib import Path
from statistics import fmean
from tempfile import TemporaryDirectory
from time import process_time

from nets import NETS, Job, mean_emd

from industnerf.artifacts.split import load_split
from industnerf.config import load_params
from industnerf.learning.procedural_shapes import load_procedural_shapes
from industnerf.learning.training_shape import Prior
from industnerf.methods import load_method
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


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("--methods", nargs="+", default=NETS)
    parser.add_argument("--solids", nargs="+", type=int, default=[100, 1000, 5000])
    parser.add_argument("--steps", nargs="+", type=int, default=[2000, 8000])
    parser.add_argument("--views", type=int)
    arguments = parser.parse_args()
    print(markdown_table(COLUMNS, []), end="")
    for job in product(arguments.methods, arguments.solids, arguments.steps):
        with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            row = pool.submit(run, arguments.data, arguments.views, *job).result()
        print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
