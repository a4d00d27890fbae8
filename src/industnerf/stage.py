"""One stage over all parts: reuse what is stored, make the rest, place the results, say so.

<out>/<part id>/...      the results
<out>/index.json         part id -> key in the store, so that costs can be looked up; and
                         digests of the results, by which later stages know what they are given
<out>/failures.json      part id -> why
"""

import math
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from industnerf import resume_time
from industnerf.artifacts.files import read_json, write_json
from industnerf.code_hash import library_versions
from industnerf.content import RECORD, RecordedDigests, content_digest
from industnerf.errors import PartsFailed
from industnerf.progress import Progress
from industnerf.runner import GroupedWork, WorkItem, WorkResult, runner_from_environment
from industnerf.store import Cost, Store, store_key
from industnerf.timing import NO_TIME, Timing

SCHEMA = 1
MAX_SHOWN_FAILURES = 10  # failures that are named where a stage refuses


@dataclass(frozen=True)
class Task:
    """What to do for one part, or one net: `make(target)` fills the folder `target`.

    It may return which of its time is to stand aside: `Cost.extra_seconds`.
    `settings` and the content of `inputs` are all that the result may depend on, beside the code
    of the module in which `make` is defined, and of `modules`.  If the task is `resumable`, `make`
    is also given the folder `scratch`, which it may fill to go on from after an interruption.
    """

    part_id: str
    make: "partial[Timing | None]"
    settings: Any
    inputs: tuple[Path, ...]
    modules: tuple[str, ...] = ()
    resumable: bool = False


@dataclass(frozen=True)
class Batch:
    """The tasks of one output folder: of a stage, or of one method in it.

    `earlier_failures` are parts that failed in a stage before, with the reason.
    """

    tasks: Sequence[Task]
    out: Path
    earlier_failures: Mapping[str, str] = field(default_factory=dict)


def run_stage(
    stage: str,
    tasks: Sequence[Task],
    out: Path,
    on_failure: str,
    *,
    earlier_failures: Mapping[str, str] | None = None,
    limit_s: float = math.inf,
    memory_mb: int | None = None,
    needs_one: bool = True,
    failures_are_losses: bool = False,
) -> None:
    """Bring every task's result to `out`, finished ones from the store.

    A part that takes more than `limit_s` seconds or `memory_mb` of memory fails.

    Raises PartsFailed, after everything else is stored and placed, if a part failed and
    `on_failure` is `strict`, or if not one part succeeded and `needs_one`: a later stage can do
    nothing then.  It also does where a part was lost, by the cluster or for want of memory, of room
    on a disk or in a GPU: that is no result, and DVC must not take it for one.  With
    `failures_are_losses` every failure is one: of the stage's own code, and not of a part's.
    Raises BadParams before anything is done for what INDUSTNERF_* do not allow.
    """
    (run,) = _make_all(stage, [Batch(tasks, out, earlier_failures or {})], limit_s, memory_mb)
    run.finish(on_failure, needs_one=needs_one, failures_are_losses=failures_are_losses)


def run_methods(
    stage: str,
    batches: Mapping[str, Batch],
    out: Path,
    on_failure: str,
    *,
    limit_s: float = math.inf,
    failures_are_losses: bool = False,
    shares_processes: bool = False,
) -> None:
    """`run_stage` for the batch of every method; `<out>/index.json` then stands for all.

    The tasks of all methods are one queue: no core waits for the last part of a method.  With
    `shares_processes` a process does those of several methods, and their memory is not told apart.

    Raises PartsFailed with the failures of all methods, as `run_stage` does.
    """
    refusals, groups = [], None if shares_processes else list(batches)
    runs = _make_all(stage, list(batches.values()), limit_s, None, groups)
    for name, run in zip(batches, runs, strict=True):
        try:
            run.finish(on_failure, needs_one=False, failures_are_losses=failures_are_losses)
        except PartsFailed as error:
            refusals.append(f"{name}: {error}")
    records = {
        name: [batch.out / f"{kind}.json" for kind in ("index", "failures")]
        for name, batch in batches.items()
    }
    digests = {name: content_digest(paths) for name, paths in records.items()}
    write_json(out / RECORD, {"schema": SCHEMA, "step": stage, "methods": digests})
    if refusals:
        raise PartsFailed("\n".join(refusals))


def _make_all(
    stage: str,
    batches: Sequence[Batch],
    limit_s: float,
    memory_mb: int | None,
    groups: Sequence[str] | None = None,
) -> "list[_Run]":
    """Have every result made that the store lacks; `groups` has one for each of `batches`."""
    store, recorded = Store.from_environment(), RecordedDigests()
    runs = [_Run(stage, store, batch, recorded) for batch in batches]
    pending = [(number, i) for number, run in enumerate(runs) for i in run.pending]
    work_items = [
        GroupedWork(runs[number].work_item(i), groups[number] if groups else "")
        for number, i in pending
    ]
    labels = [(runs[number].label, runs[number].batch.tasks[i].part_id) for number, i in pending]
    runner, num_tasks = runner_from_environment(), sum(len(batch.tasks) for batch in batches)
    workers = getattr(runner, "workers", 1)
    with Progress(stage, labels, num_tasks - len(pending), workers) as progress:
        for outcome in runner.map(work_items, limit_s, memory_mb):
            number, i = pending[outcome.index]
            runs[number].note(i, outcome)
            progress.advance(outcome.index, outcome.error, store.cost(stage, runs[number].keys[i]))
    return runs


class _Run:
    """One batch on its way: its keys in the store, and which of its parts failed or were lost."""

    def __init__(self, stage: str, store: Store, batch: Batch, recorded: RecordedDigests) -> None:
        self.stage, self.store, self.batch = stage, store, batch
        self.keys = [_store_key(stage, task, recorded) for task in batch.tasks]
        self.pending = [i for i, key in enumerate(self.keys) if not store.has(stage, key)]
        self.failures, self.lost = dict(batch.earlier_failures), set[str]()

    @property
    def label(self) -> str:
        """The method, or what else is one of several; empty for a stage as a whole."""
        return "" if self.batch.out.name == self.stage else self.batch.out.name

    def work_item(self, i: int) -> WorkItem:
        """What makes the result of task `i`."""
        task = self.batch.tasks[i]
        libraries = library_versions(_modules(task))
        return partial(_make_result, self.store, self.stage, self.keys[i], task, libraries)

    def note(self, i: int, outcome: WorkResult) -> None:
        """Keep how task `i` ended."""
        part_id = self.batch.tasks[i].part_id
        if outcome.error is not None:
            self.failures[part_id] = outcome.error
        if outcome.lost:
            self.lost.add(part_id)

    def finish(self, on_failure: str, *, needs_one: bool, failures_are_losses: bool) -> None:
        """Place and list the results; raises PartsFailed as `run_stage` does."""
        stage, store, out = self.stage, self.store, self.batch.out
        if failures_are_losses:
            self.lost |= self.failures.keys() - self.batch.earlier_failures.keys()
        index = {}
        for task, key in zip(self.batch.tasks, self.keys, strict=True):
            if task.part_id in self.failures:
                continue
            if store.has(stage, key):  # it may be long since this was asked
                store.checkout(stage, key, out / task.part_id)
                index[task.part_id] = key
            else:
                reason = "its result in the store was damaged or removed meanwhile"
                self.failures[task.part_id] = reason
                self.lost.add(task.part_id)
        contents = {part_id: store.contents(stage, key) for part_id, key in index.items()}
        record = {"schema": SCHEMA, "step": stage, "keys": index, "contents": contents}
        write_json(out / RECORD, record)
        ordered = dict(sorted(self.failures.items()))  # they come in the order in which parts end
        write_json(out / "failures.json", {"schema": SCHEMA, "failures": ordered})
        is_empty = needs_one and not index
        if self.lost or (self.failures and (on_failure == "strict" or is_empty)):
            raise _failure_error(stage, out, self.failures, len(index), self.lost, is_empty)


def read_index(folder: Path) -> dict[str, str]:
    """Part id -> key in the store of each result in the stage output `folder`.

    Raises BadArtifact if the stage was not run, as does `read_failures`.
    """
    return _read_record(folder / RECORD)["keys"]


def read_failures(folder: Path) -> dict[str, str]:
    """Part id -> reason of each part that failed in the stage output `folder`, or before it."""
    return _read_record(folder / "failures.json")["failures"]


def _read_record(path: Path) -> Any:
    return read_json(path, SCHEMA, stage_of_output(path.parent))


def stage_of_output(folder: Path) -> str:
    """The name that dvc.yaml has for the stage with this output, or with this method's in it."""
    stages_by_folder = {
        "weights": "pretrain",
        "states": "train",
        "clouds": "reconstruct",
        "scores": "evaluate",
    }
    own_stage = stages_by_folder.get(folder.name, folder.name)
    return stages_by_folder.get(folder.parent.name, own_stage)


def _store_key(stage: str, task: Task, recorded: RecordedDigests) -> str:
    return store_key(stage, task.settings, _modules(task), task.inputs, recorded)


def _modules(task: Task) -> tuple[str, ...]:
    return (task.make.func.__module__, *task.modules)


def _make_result(
    store: Store, stage: str, key: str, task: Task, libraries: Mapping[str, str]
) -> None:
    if store.has(stage, key):  # made meanwhile, or before the job that makes it was started again
        return
    if not task.resumable:
        store.put(stage, key, partial(run_timed, task.make), libraries)
        return
    scratch = store.scratch_dir(stage, key)
    earlier_seconds = resume_time.start_timer(scratch)
    make = partial(task.make, scratch=scratch)
    store.put(stage, key, lambda target: run_timed(make, target, earlier_seconds), libraries)


def run_timed(
    make: Callable[[Path], Timing | None], target: Path, earlier_seconds: float = 0.0
) -> Cost:
    """What it takes to run `make(target)` in this process; it may return time to set aside.

    `earlier_seconds` are those of earlier attempts that it goes on from, by the clock; these
    ran in another process, and as many count for the processor.
    """
    _reset_peak()
    start = Timing.now()
    extra = make(target) or NO_TIME
    own = Timing.now() - start - extra
    return Cost(
        round(earlier_seconds + own.wall, 4),
        _peak_mb(),
        _device(),
        round(extra.wall, 4),
        round(earlier_seconds + own.cpu, 4),
        round(extra.cpu, 4),
    )


def _device() -> str:
    """Where this process has computed: `cuda`, or `cpu`."""
    torch, warp = sys.modules.get("torch"), sys.modules.get("warp")
    is_gpu_used = bool(torch and torch.cuda.is_initialized())
    is_gpu_used |= bool(warp and any(gpu.has_context for gpu in warp.get_cuda_devices()))
    return "cuda" if is_gpu_used else "cpu"


def _reset_peak() -> None:
    if sys.platform == "linux" and os.access("/proc/self/clear_refs", os.W_OK):
        Path("/proc/self/clear_refs").write_text("5")


def _peak_mb() -> float:
    import resource

    if sys.platform == "linux":
        for line in Path("/proc/self/status").read_text().splitlines():
            if line.startswith("VmHWM"):
                return round(int(line.split()[1]) / 1024, 1)
    return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20, 1)


def _failure_error(
    stage: str,
    out: Path,
    failures: dict[str, str],
    num_succeeded: int,
    lost: set[str],
    is_empty: bool,
) -> PartsFailed:
    first = sorted(failures, key=lambda part: part not in lost)[:MAX_SHOWN_FAILURES]
    listing = "".join(f"  {part}: {failures[part]}\n" for part in first)
    if more := len(failures) - len(first):
        listing += f"  and {more} more: {out / 'failures.json'}\n"
    unit, advice = "parts", "Mend or deselect them (parts.select), or set on_failure: report."
    if stage == "train":
        unit = "nets"
        advice = "Mend what is named; with on_failure: report their parts count as failed."
    if is_empty:
        advice = "No later stage can do anything then: mend them, or choose other parts."
    if lost:
        advice = (
            f"Of these, {len(lost)} were lost by the machine, the cluster or a metric, which says "
            "nothing of them: mend what is named, and give the same command again."
        )
    return PartsFailed(
        f"stage {stage}: {len(failures)} of {len(failures) + num_succeeded} {unit} failed, the "
        f"rest are stored. Failed:\n{listing}{advice}"
    )
