"""Do the gates of `r2n2` stay open while it is pretrained?

OMP_NUM_THREADS=1 python benchmarks/r2n2_gates.py DATA [--rates 1e-3 3e-4] [--solids 1000 5000]
    [--seeds 0 1 2] [--steps 400]

DATA is the folder `data` of a finished run, of which `procedural` is read.  Each row is the start
of a pretraining by params.yaml, but for the rate, and about a minute of one core.  `loss` is the
mean of its last 100 steps.  `saturated` is the share of the gates' arguments beyond 4 and -4, where
less than 2 % of a gradient passes, at the last view of eight solids that are held out.  `spread` is
the standard deviation of the answers between these solids, in logits: 0 is blind to pictures.
"""

import argparse
from contextlib import suppress
from dataclasses import replace
from itertools import product
from pathlib import Path
from statistics import fmean
from tempfile import TemporaryDirectory

import numpy as np
import torch
from torch import Tensor

from industnerf.config import load_params
from industnerf.learning.procedural_shapes import ProceduralShape, load_procedural_shapes
from industnerf.learning.training import TrainingSplit, train, train_val_split
from industnerf.methods.r2n2.network import R2N2, new_net
from industnerf.methods.r2n2.train import R2N2Dataset
from industnerf.report.tables.formats import markdown_table
from industnerf.stage import read_index
from industnerf.torch_kernels import use_reproducible_kernels

COLUMNS = ("rate", "solids", "seed", "loss", "saturated", "spread")
HELD_OUT, SATURATION = 8, 4.0


class EnoughSteps(Exception):
    """Breaks a training off, whose rate falls as that of a whole one."""


def row(shapes: list[ProceduralShape], rate: float, seed: int, steps: int) -> list[str]:
    """One row of COLUMNS."""
    settings = load_params().method.r2n2
    training = replace(settings.pretraining, lr=rate, val_interval=10**9)
    net = new_net(settings.image_px, settings.channel_divisor, seed)
    dataset = R2N2Dataset.of(shapes, settings, net)
    train_ids, val_ids = train_val_split(shapes, training.val_fraction)
    losses: list[float] = []

    def loss(ids: np.ndarray, rng: np.random.Generator) -> Tensor:
        if len(losses) == steps:
            raise EnoughSteps
        value = dataset.loss(ids, rng)
        losses.append(value.item())
        return value

    with TemporaryDirectory() as scratch, suppress(EnoughSteps):
        train(net, loss, TrainingSplit(train_ids, val_ids), training, seed, Path(scratch) / "c")
    saturated, spread = gates(dataset, net, np.array(val_ids[:HELD_OUT]))
    return [
        *(f"{rate:g}", str(len(shapes)), str(seed)),
        *(f"{fmean(losses[-100:]):.3f}", f"{100 * saturated:.0f} %", f"{spread:.2f}"),
    ]


@torch.no_grad()
def gates(dataset: R2N2Dataset, net: R2N2, ids: np.ndarray) -> tuple[float, float]:
    """The share of saturated arguments of the three gates, and the spread of the answers."""
    net.eval()
    arguments: dict[str, Tensor] = {}
    for name in ("update", "reset", "candidate"):
        getattr(net.gru, name).register_forward_hook(
            lambda _, __, value, name=name: arguments.update({name: value})
        )
    rng, sampler = np.random.default_rng(0), dataset.view_sampler
    views = range(dataset.max_views)
    contrasts = [sampler.contrasts(net, ids, len(ids) * [view], rng)[0] for view in views]
    empty, full = net(torch.stack(contrasts, dim=1)).unbind(dim=1)
    saturated = fmean(float((x.abs() > SATURATION).float().mean()) for x in arguments.values())
    return saturated, float((full - empty).std(dim=0).mean())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("--rates", nargs="+", type=float, default=[1e-3, 3e-4])
    parser.add_argument("--solids", nargs="+", type=int, default=[1000, 5000])
    parser.add_argument("--seeds", nargs="+", type=int, default=[0, 1, 2])
    parser.add_argument("--steps", type=int, default=400)
    arguments = parser.parse_args()
    use_reproducible_kernels()
    folder = arguments.data / "procedural"
    solids = load_procedural_shapes(folder, list(read_index(folder)))
    shapes = [solid for solid in solids if solid.resembles is None]  # as the stage pretrain does
    print(markdown_table(COLUMNS, []), end="")
    for rate, count, seed in product(arguments.rates, arguments.solids, arguments.seeds):
        cells = row(shapes[:count], rate, seed, arguments.steps)
        print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
