"""What does a part cost beside the work on it: in stages, store and keys, DVC, report and MLflow?

PYTHONPATH=src:. python benchmarks/tiny_parts.py 500 2000

Half boxes, five photographs of 8x8 px, two methods.  Stages, DVC, report and MLflow are the real
ones; what they would compute is made up (`small_files.py`), and its time subtracted.  In ms a
part, of the wall and of the processor; "again" is a second run elsewhere that finds all of it in
the store.
"""

import io
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from functools import partial
from pathlib import Path
from typing import Any

import small_files
from rich.console import Console
from rich.table import Table

from industnerf import config, stage
from industnerf.parts.catalogue.sources import PartTask
from industnerf.store import Store
from industnerf.tracking import log_report, prepare_database
from pipeline import in_process
from pipeline.preset import create_project
from pipeline.stages import evaluate, parts, reconstruct, truth, views

PRESET = (
    *("experiment=smoke", "methods=[ball,hull]", "views.count=4", "views.held_out=1"),
    *("procedural.solids=0", "pretrain.weights=none", "parts.select=[]"),
)
Seconds = dict[str, list[float]]  # wall and processor


def main(*counts: str) -> None:
    root, columns = Path.cwd(), {}
    for count in map(int, counts):
        with tempfile.TemporaryDirectory() as folder:
            columns[count] = measure(root, Path(folder), count)
    table = Table("ms a part", *(f"{count} parts: wall (processor)" for count in columns))
    for name in next(iter(columns.values())):
        rows = [[1e3 * s / count for s in seconds[name]] for count, seconds in columns.items()]
        table.add_row(name, *(f"{wall:.2f} ({processor:.2f})" for wall, processor in rows))
    Console(width=120).print(table)


def measure(root: Path, folder: Path, count: int) -> Seconds:
    """Seconds of the wall and of the processor, by what took them."""
    os.environ |= {
        "INDUSTNERF_STORE": str(folder / "store"),
        "INDUSTNERF_RUNNER": "serial",
        "INDUSTNERF_MLFLOW": str(folder),
    }
    project, seconds = folder / "project", defaultdict(lambda: [0.0, 0.0])
    make_up_work(count)
    os.chdir(root)
    create_project(root, project, list(PRESET))
    os.chdir(project)
    params = config.load_params()
    for suffix, target in (("", project), (", again", folder / "again")):
        apart, whole = parts_timed(seconds, suffix), timed(seconds, f"all stages{suffix}")
        with apart, whole, redirect_stdout(io.StringIO()):
            in_process.run_pipeline(params, target)
    with timed(seconds, "DVC: take over all outputs"):
        subprocess.run(["dvc", "commit", "-f", "-q"], check=True)
    with timed(seconds, "DVC: nothing to do"):
        subprocess.run(["dvc", "repro", "-q"], check=True)
    prepare_database()
    with timed(seconds, "MLflow: log the report"):
        log_report(project / "reports", {"seed": 0})
    size = sum(path.stat().st_size for path in Path("data").rglob("*") if path.is_file())
    files = sum(1 for path in Path("data").rglob("*") if path.is_file())
    page = (project / "reports/report.html").stat().st_size
    print(f"{count} parts: {files} files, {size / 1e6:.1f} MB in data/, page {page / 1e6:.1f} MB")
    os.chdir(root)
    return seconds


def make_up_work(count: int) -> None:
    """Stages that find what they would compute ready-made."""
    tasks = [PartTask(f"box-{i:05}", partial(small_files.make_box, i), i, ()) for i in range(count)]
    parts.embedded_parts = lambda folder, select: tasks
    views.render_part = small_files.photograph
    truth.measure_truth = small_files.sample_truth
    reconstruct.reconstruct_part = small_files.guess_cloud
    evaluate.score_part = small_files.draw_scores


@contextmanager
def parts_timed(seconds: Seconds, suffix: str) -> Iterator[None]:
    """Counts keys, storing, finding, placing and the report apart."""
    report = in_process.import_module("pipeline.stages.report")
    places: list[tuple[Any, str, str]] = [
        (stage, "store_key", "keys"),
        (Store, "put", "store: put"),
        (Store, "has", "store: find"),
        (Store, "checkout", "store: place"),
        (report, "main", "report"),
    ]
    originals = [getattr(owner, name) for owner, name, _ in places]

    def wrapped(function: Any, label: str) -> Any:
        def call(*arguments: Any, **keywords: Any) -> Any:
            with timed(seconds, f"{label}{suffix}"):
                return function(*arguments, **keywords)

        return call

    for (owner, name, label), original in zip(places, originals, strict=True):
        setattr(owner, name, wrapped(original, label))
    yield
    for (owner, name, _), original in zip(places, originals, strict=True):
        setattr(owner, name, original)


@contextmanager
def timed(seconds: Seconds, label: str) -> Iterator[None]:
    """Adds what happens within, less what making results takes."""
    before = clocks()
    yield
    for i, (end, start) in enumerate(zip(clocks(), before, strict=True)):
        seconds[label][i] += end - start


def clocks() -> tuple[float, float]:
    """Wall and processor seconds, those of children that ended included."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = time.process_time() + children.ru_utime + children.ru_stime
    wall, own = small_files.own_seconds
    return time.perf_counter() - wall, processor - own


if __name__ == "__main__":
    main(*sys.argv[1:])
