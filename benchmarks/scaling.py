"""What does a part cost beside the work on it: in the store, in DVC, in MLflow, in SLURM?

python benchmarks/scaling.py costs [data]      seconds a part and step, as the store noted them
python benchmarks/scaling.py keys [data]       what each stage reads of every part, by its record
python benchmarks/scaling.py stored            a stage with nothing to do, against parts
python benchmarks/scaling.py dvc               a stage's output in DVC, against files
python benchmarks/scaling.py mlflow            a method's run, against parts
PYTHONPATH=. python benchmarks/scaling.py slurm   arrays of jobs; needs what tests/slurm needs

`data` is a finished data folder of the suite, ./data by default.  All but `costs` and `keys` make
what they measure in a temporary folder: small files, because it is their number that counts.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from statistics import fmean

from rich.console import Console
from rich.table import Table
from small_files import fill

from industnerf.artifacts.views import ARCHIVE, CAMERAS
from industnerf.content import RecordedDigests, content_digest
from industnerf.runner import runner_from_environment
from industnerf.stage import Task, read_index, run_stage
from industnerf.store import Store
from industnerf.tracking import log_report, prepare_database

FILES = 147  # of a part's photographs, were they no archive: 48 times three, and cameras
READ = {  # what a stage reads of every part, by the folder of the stage before
    "views": {"parts": ["part.json", "mesh.npz"]},
    "truth": {"parts": ["mesh.npz"]},
    **{
        f"reconstruct, {kind}": {"views": [f"{ARCHIVE}/{name}" for name in (CAMERAS, kind)]}
        for kind in ("rgb", "mask", "depth")
    },
}


def costs(data: str = "data") -> None:
    """Mean, median and largest cost of every stage, and of every method of matrix stages."""
    store, rows = Store.from_environment(), []
    for index in sorted(Path(data).glob("**/index.json")):
        step = json.loads(index.read_text())["step"]
        step_costs = [store.cost(step, key) for key in read_index(index.parent).values()]
        seconds = sorted(cost.seconds for cost in step_costs if cost)
        if seconds:
            name = str(index.parent.relative_to(data))
            median_seconds = seconds[len(seconds) // 2]
            max_peak_mb = max(cost.peak_mb for cost in step_costs if cost)
            rows.append(
                [name, len(seconds), fmean(seconds), median_seconds, seconds[-1], max_peak_mb]
            )
    show(["step", "results", "s mean", "s median", "s most", "MB most"], rows)


def keys(data: str = "data") -> None:
    """How long the digest of a stage's inputs takes: recorded, and read anew."""
    rows = []
    for stage, inputs in READ.items():
        [(folder, names)] = inputs.items()
        parts = sorted(read_index(Path(data) / folder))
        paths = [[Path(data) / folder / part / name for name in names] for part in parts]
        milliseconds = []
        for recorded in (RecordedDigests(), None):
            start = time.perf_counter()
            for part_paths in paths:
                content_digest(part_paths, recorded)
            milliseconds.append(1e3 * (time.perf_counter() - start) / len(parts))
        rows.append([stage, len(parts), *milliseconds])
    show(["reads", "parts", "ms a part, recorded", "ms a part, read"], rows)


def stored() -> None:
    """A stage that makes nothing but files, then the same again, with everything in the store."""
    rows = []
    for parts, files in ((100, 1), (400, 1), (1600, 1), (20, FILES), (80, FILES)):
        with scratch() as folder:
            os.environ |= {"INDUSTNERF_STORE": str(folder / "store"), "INDUSTNERF_RUNNER": "serial"}
            source = folder / "source"
            source.write_text("same")
            tasks = [Task(f"part-{i}", partial(fill, files), i, (source,)) for i in range(parts)]
            seconds = []
            for _ in range(2):
                start = time.perf_counter()
                run_stage("made", tasks, folder / "out", "strict")
                seconds.append(time.perf_counter() - start)
            size = (folder / "out" / "index.json").stat().st_size
        rows.append([parts, files, *(1e3 * s / parts for s in seconds), size / parts])
    show(["parts", "files a part", "ms a part, made", "ms a part, stored", "index B a part"], rows)


def dvc() -> None:
    """`dvc repro` that hashes and caches an output, one with nothing to do, and what it keeps."""
    rows = []
    for parts in (10, 40, 120):
        with scratch() as folder:
            for i in range(parts):
                (folder / "made" / f"part-{i}").mkdir(parents=True)
                fill(FILES, folder / "made" / f"part-{i}")
            (folder / "dvc.yaml").write_text(
                "stages: {s: {cmd: cp -r made out && date > stamp, outs: [out]}}"
            )
            for command in (["init", "--no-scm", "-q"], ["config", "cache.type", "reflink,copy"]):
                subprocess.run(["dvc", *command], cwd=folder, check=True)
            copying = time_command(["cp", "-r", "made", "copy"], folder)
            first, second = (time_command(["dvc", "repro", "-q"], folder) for _ in range(2))
            listing = next((folder / ".dvc" / "cache").rglob("*.dir")).stat().st_size
            lock = (folder / "dvc.lock").stat().st_size
        rows.append([parts * FILES, first - copying, second, listing / 1e3, lock / 1e3])
    show(["files", "s first, less making them", "s nothing to do", "listing kB", "lock kB"], rows)


def mlflow() -> None:
    """Log a report of one method and so many parts, with eight metrics each."""
    rows = []
    for count in (100, 1000, 10_000, 100_000):
        with scratch() as folder:
            os.environ["INDUSTNERF_MLFLOW"] = str(folder)
            report = folder / "reports"
            report.mkdir()
            write_report(report, count)
            prepare_database()
            start, cpu_start = time.perf_counter(), time.process_time()
            log_report(report, {"seed": 0})
            seconds, cpu_seconds = time.perf_counter() - start, time.process_time() - cpu_start
            table = sum(p.stat().st_size for p in (folder / "mlruns").rglob("per_part.json"))
            database = (folder / "mlflow.db").stat().st_size
        rows.append([count, seconds, cpu_seconds, table / 1e6, database / 1e6])
    show(["parts", "s", "cpu s", "table MB", "database MB"], rows)


def slurm() -> None:
    """Submit arrays of jobs that cannot start; then send pieces of work that do nothing."""
    from tests.slurm.cluster import CORES, Cluster, unavailable_reason

    if reason := unavailable_reason():
        sys.exit(f"no SLURM: {reason}")
    rows = []
    with scratch() as folder:
        cluster = Cluster(folder)
        cluster.start()
        os.environ |= cluster.environment | {
            "INDUSTNERF_RUNNER": "submitit",
            "INDUSTNERF_SLURM_FOLDER": str(folder / "logs"),
            "INDUSTNERF_SLURM_POLL_S": "1",
            "PYTHONPATH": os.pathsep.join(sys.path),
        }
        try:
            for jobs in (10, 100, 250):
                rows.append([f"submit an array of {jobs}", time_submission(jobs)])
            for pieces, jobs in ((8, 8), (80, 8)):
                name = f"{pieces} empty pieces in {jobs} jobs on {CORES} cores"
                rows.append([name, time_empty_tasks(pieces, pieces // jobs)])
        finally:
            cluster.stop()
    show(["", "s"], rows)


def time_submission(jobs: int) -> float:
    """Seconds until SLURM has an array of `jobs`, which are then cancelled."""
    os.environ |= {"INDUSTNERF_SLURM_PARTITION": "closed", "INDUSTNERF_SLURM_CHUNK": "1"}
    from industnerf.runner.chunk import Chunk
    from industnerf.runner.job_status import JobStatus
    from industnerf.runner.slurm import SlurmRunner

    runner = runner_from_environment()
    assert isinstance(runner, SlurmRunner)
    folder = runner.wait_settings.folder / f"submit-{jobs}"
    folder.mkdir(parents=True)
    start = time.perf_counter()
    runner._submit(
        folder, [Chunk(((i, int),), JobStatus(folder), 1, 60.0, None) for i in range(jobs)]
    )
    seconds = time.perf_counter() - start
    subprocess.run(["scancel", "-u", "root"], check=True)
    return seconds


def time_empty_tasks(count: int, size: int) -> float:
    """Seconds from the call to the last outcome of `pieces` that do nothing, `size` in a job."""
    os.environ |= {"INDUSTNERF_SLURM_PARTITION": "work", "INDUSTNERF_SLURM_CHUNK": str(size)}
    start = time.perf_counter()
    outcomes = list(runner_from_environment().map([int] * count, 60.0))
    assert all(outcome.error is None for outcome in outcomes), outcomes
    return time.perf_counter() - start


def write_report(report: Path, rows: int) -> None:
    """The files of a report that MLflow is given, with `rows` parts of one method."""
    metrics = ("emd", "chamfer", "fscore", *(f"m{j}" for j in range(5)))
    head = "part_id,family,split,method,scope,metric,protocol,value,floor,status\n"
    lines = [
        f"p{i},gears,test,m,part,{name},P1-even,0.01,0.005,ok\n"
        for i in range(rows)
        for name in metrics
    ]
    (report / "scores.csv").write_text(head + "".join(lines))
    lines = [f"p{i},m,reconstruct,1.0,100.0\n" for i in range(rows)]
    (report / "cost.csv").write_text("part_id,method,stage,seconds,peak_mb\n" + "".join(lines))
    names = "method,scope,inputs,split,preset,ci_low,ci_high,emd_mm,seeds_sd,parameters,steps\n"
    (report / "table1.csv").write_text(f"{names}m,part,rgb,test,scaling,0,1,1,,0,0\n")


def time_command(command: list[str], folder: Path) -> float:
    start = time.perf_counter()
    subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - start


@contextmanager
def scratch() -> Iterator[Path]:
    with tempfile.TemporaryDirectory() as folder:
        yield Path(folder)


def show(head: list[str], rows: list[list[object]]) -> None:
    table = Table(*head)
    for row in rows:
        table.add_row(*(f"{v:.3g}" if isinstance(v, float) else str(v) for v in row))
    Console(width=120).print(table)


if __name__ == "__main__":
    measured = {f.__name__: f for f in (costs, keys, stored, dvc, mlflow, slurm)}
    measured[sys.argv[1]](*sys.argv[2:])
