"""What equal bytes on every processor cost and change: AVX2 against what libraries choose.

python benchmarks/pinning.py [--repeats 3]      processor seconds of a reconstruction or a training
python benchmarks/pinning.py --emd              EMD (even) of four dev parts with both

Runs turn about, each in a process of its own: kernels are chosen as libraries load.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

METHODS = ("industnerf", "industnerf_plus", "carve", "r2n2", "atlasnet", "occupancy")
TRAINING_STEPS = 60  # of a network
TIMED_PART = "enclosure-120x80x40"
SCORED_METHODS = ("industnerf", "industnerf_plus")
SCORED_PARTS = (
    "clock-wheel-m1-z48",
    "heat-sink-plate-fin-80x60",
    "manifold-iso4401-03-3",
    "turbine-blade-115",
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--emd", action="store_true")
    parser.add_argument("--measure", nargs=4, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.measure:
        quantity, name, part_id, mode = arguments.measure
        if mode == "free":
            choose_freely()
        print(json.dumps({"seconds": measure_seconds, "emd": measure_emd}[quantity](name, part_id)))
        return
    if arguments.emd:
        print_emds()
    else:
        print_seconds(arguments.repeats)


def print_seconds(repeats: int) -> None:
    for name in METHODS:
        seconds: dict[str, list[float]] = {"pinned": [], "free": []}
        for _ in range(repeats):
            for mode, values in seconds.items():
                values.append(run("seconds", name, TIMED_PART, mode))
        pinned, free = (statistics.median(values) for values in seconds.values())
        print(f"{name:16} pinned {pinned:6.2f} s  free {free:6.2f} s  ratio {pinned / free:.2f}")


def print_emds() -> None:
    for name in SCORED_METHODS:
        for part_id in SCORED_PARTS:
            pinned, free = (run("emd", name, part_id, mode) for mode in ("pinned", "free"))
            change = 100 * (free / pinned - 1)
            print(f"{name:16} {part_id:26} pinned {pinned:.5f}  free {free:.5f}  {change:+.1f} %")


def run(quantity: str, name: str, part_id: str, mode: str) -> float:
    command = [sys.executable, __file__, "--measure", quantity, name, part_id, mode]
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    output = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    return json.loads(output.stdout.splitlines()[-1])


def choose_freely() -> None:
    """Undo, before the libraries load, what holds them to AVX2."""
    from industnerf import processor

    for variable in processor.PINNED.keys() - {"OPENBLAS_NUM_THREADS"}:
        del os.environ[variable]
    import warp

    from industnerf import torch_kernels
    from industnerf.geometry import warp_runtime

    warp_runtime.CPU_FLAGS = warp.config.cpu_compiler_flags
    torch_kernels.register_kernels = lambda: None


def measure_seconds(name: str, part_id: str) -> float:
    """Processor seconds of the second of two runs: the first one compiles."""
    work = prepare(name, part_id)
    work()
    start = time.process_time()
    work()
    return time.process_time() - start


def measure_emd(name: str, part_id: str) -> float:
    """EMD (even) of 4096 points, in diagonals, of a reconstruction."""
    import numpy as np

    from industnerf.geometry.sampling import sample_surface
    from industnerf.metrics.emd import emd
    from industnerf.metrics.subsample import farthest_points
    from industnerf.parts.catalogue.entries import (
        EMBEDDED_FOLDER,
        load_catalogue_mesh,
        read_catalogue,
    )

    points_mm = prepare(name, part_id)().points_mm
    entries = {entry.id: entry for entry in read_catalogue(EMBEDDED_FOLDER)}
    mesh = load_catalogue_mesh(entries[part_id])
    diagonal_mm = np.linalg.norm(np.ptp(mesh.vertices, axis=0))
    truth_mm = sample_surface(mesh.vertices, mesh.faces, 65536, np.random.default_rng(0))[0]
    clouds = (farthest_points(points / diagonal_mm, 4096) for points in (points_mm, truth_mm))
    return emd(*clouds).value


def prepare(name: str, part_id: str) -> Callable[[], Any]:
    """A training of a network on one part, or a reconstruction by another method."""
    import dataclasses
    import tempfile

    from industnerf import config
    from industnerf.capture.render import render_part
    from industnerf.methods import load_method
    from industnerf.methods.base import Example, Scope, load_inputs
    from industnerf.parts.catalogue.sources import embedded_parts

    params = config.load_params()
    method, settings = load_method(name), getattr(params.method, name)
    folder = Path(tempfile.mkdtemp())
    views = dataclasses.replace(params.views, count=20, resolution=256)
    for part in embedded_parts(Path(params.parts.path), [part_id]):
        for kind in ("parts", "views"):
            (folder / kind / part_id).mkdir(parents=True)
        part.make(folder / "parts" / part_id)
        render_part(folder / "parts" / part_id, folder / "views" / part_id, views, params.seed)
    folders = folder / "parts" / part_id, folder / "views" / part_id
    if method.scope == Scope.DATASET:
        training = dataclasses.replace(settings.training, max_steps=TRAINING_STEPS)
        settings = dataclasses.replace(settings, training=training)
        example = Example(part_id, part_id, *folders, method.inputs)

        def train() -> None:
            method.fit([example], settings, params.seed, Path(tempfile.mkdtemp()))

        return train
    inputs = load_inputs(method, *folders, 0)
    return lambda: method.reconstruct(inputs, settings, None, params.seed)


if __name__ == "__main__":
    main()
