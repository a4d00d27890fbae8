"""What it costs to give the same bytes on every processor: AVX2 against what libraries choose.

python benchmarks/pinning.py [--repeats 3]

Runs turn about, each in a process of its own: kernels are chosen as libraries load.  Processor
seconds, and their ratio, of one reconstruction or one training each.
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
PARTS = ["enclosure-120x80x40", "clevis-din71752-g12x24"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--measure", nargs=2, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.measure:
        name, mode = arguments.measure
        print(json.dumps(measure(name, mode)))
        return
    for name in METHODS:
        seconds: dict[str, list[float]] = {"pinned": [], "free": []}
        for _ in range(arguments.repeats):
            for mode, values in seconds.items():
                values.append(run(name, mode))
        pinned, free = (statistics.median(values) for values in seconds.values())
        print(f"{name:16} pinned {pinned:6.2f} s  free {free:6.2f} s  ratio {pinned / free:.2f}")


def run(name: str, mode: str) -> float:
    command = [sys.executable, __file__, "--measure", name, mode]
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    output = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    return json.loads(output.stdout.splitlines()[-1])


def measure(name: str, mode: str) -> float:
    """Processor seconds of the second of two runs: the first one compiles."""
    from industnerf import processor

    if mode == "free":
        for variable in processor.PINNED.keys() - {"OPENBLAS_NUM_THREADS"}:
            del os.environ[variable]
        import warp

        from industnerf import torch_kernels
        from industnerf.geometry import warp_runtime

        warp_runtime.CPU_FLAGS = warp.config.cpu_compiler_flags
        torch_kernels.register_kernels = lambda: None
    work = prepare(name)
    work()
    start = time.process_time()
    work()
    return time.process_time() - start


def prepare(name: str) -> Callable[[], Any]:
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
    for part in embedded_parts(Path(params.parts.path), PARTS):
        for kind in ("parts", "views"):
            (folder / kind / part.part_id).mkdir(parents=True)
        part.make(folder / "parts" / part.part_id)
        render_part(
            folder / "parts" / part.part_id, folder / "views" / part.part_id, views, params.seed
        )
    target = PARTS[0]
    if method.scope == Scope.DATASET:
        training = dataclasses.replace(settings.training, max_steps=TRAINING_STEPS)
        settings = dataclasses.replace(settings, training=training)
        folders = folder / "parts" / target, folder / "views" / target
        example = Example(target, target, *folders, method.inputs)

        def train() -> None:
            method.fit([example], settings, params.seed, Path(tempfile.mkdtemp()))

        return train
    inputs = load_inputs(method, folder / "parts" / target, folder / "views" / target, 0)
    return lambda: method.reconstruct(inputs, settings, None, params.seed)


if __name__ == "__main__":
    main()
