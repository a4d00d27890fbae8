"""A stage over all parts: reuse, failures, and what it writes."""

import errno
import json
import os
import subprocess
import sys
import time
from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import pytest

from industnerf import stage
from industnerf.errors import BadArtifact, BadPart, PartsFailed
from industnerf.runner import WorkResult
from industnerf.stage import Task, read_failures, read_index, run_stage
from industnerf.timing import Timing


def write_double(source, target, *, log):
    """Write twice the number in `source`; refuse 13.  Every call leaves a line in `log`."""
    number = int(source.read_text())
    with log.open("a") as file:
        file.write(f"{number}\n")
    if number == 13:
        raise BadPart("thirteen")
    (target / "twice").write_text(str(2 * number))


def write_unless_full(target, *, full):
    """Write, unless there is a file `full`."""
    if full.exists():
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(target))
    (target / "done").touch()


def sleep_and_return(target, *, total_s, extra_s):
    """Take `total_s` seconds, `extra_s` of them for something else."""
    (target / "done").touch()
    time.sleep(total_s)
    return None if extra_s is None else Timing(extra_s, 0.0)


@pytest.fixture
def workdir(tmp_path, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_STORE", str(tmp_path / "store"))
    monkeypatch.setenv("INDUSTNERF_RUNNER", "serial")
    return tmp_path


def make_tasks(workdir, numbers, settings=0):
    for number in numbers:
        (workdir / f"in{number}").write_text(str(number))
    log = workdir / "log"
    return [
        Task(
            f"p{n}",
            partial(write_double, workdir / f"in{n}", log=log),
            settings,
            (workdir / f"in{n}",),
        )
        for n in numbers
    ]


def logged_calls(workdir):
    log = workdir / "log"
    numbers = log.read_text().split() if log.exists() else []
    log.unlink(missing_ok=True)
    return numbers


def test_finished_parts_are_reused(workdir):
    run_stage("s", make_tasks(workdir, [1, 2]), workdir / "out", "strict")
    assert logged_calls(workdir) == ["1", "2"]
    run_stage("s", make_tasks(workdir, [1, 2, 3]), workdir / "out", "strict")
    assert logged_calls(workdir) == ["3"]
    assert (workdir / "out" / "p1" / "twice").read_text() == "2"
    assert list(read_index(workdir / "out")) == ["p1", "p2", "p3"]


def test_changed_settings_are_made_anew(workdir):
    run_stage("s", make_tasks(workdir, [1], settings=0), workdir / "out", "strict")
    run_stage("s", make_tasks(workdir, [1], settings=1), workdir / "out", "strict")
    assert logged_calls(workdir) == ["1", "1"]


def test_report_lists_a_failure_and_goes_on(workdir, capsys):
    run_stage("s", make_tasks(workdir, [1, 13, 2]), workdir / "out", "report")
    assert read_failures(workdir / "out") == {"p13": "thirteen"}
    assert list(read_index(workdir / "out")) == ["p1", "p2"]
    assert "p13 failed: thirteen" in capsys.readouterr().out


def test_failures_stand_in_one_order_whichever_part_ends_first(workdir, monkeypatch):
    class Backwards:
        def map(self, works, limit_s, memory_mb):
            return [WorkResult(1, "late"), WorkResult(0, "early")]

    monkeypatch.setattr(stage, "runner_from_environment", Backwards)
    run_stage("s", make_tasks(workdir, [1, 2]), workdir / "out", "report", needs_one=False)
    assert list(read_failures(workdir / "out")) == ["p1", "p2"]


def test_strict_ends_after_everything_else_is_stored(workdir):
    with pytest.raises(PartsFailed, match=r"(?s)1 of 3 parts failed.*p13: thirteen"):
        run_stage("s", make_tasks(workdir, [1, 13, 2]), workdir / "out", "strict")
    logged_calls(workdir)
    with pytest.raises(PartsFailed):
        run_stage("s", make_tasks(workdir, [1, 13, 2]), workdir / "out", "strict")
    assert logged_calls(workdir) == ["13"]


def test_a_stage_without_one_result_ends_even_in_report_mode(workdir):
    with pytest.raises(PartsFailed, match="1 of 1 parts failed"):
        run_stage("s", make_tasks(workdir, [13]), workdir / "out", "report")


def test_failures_of_earlier_stages_are_carried_on(workdir):
    run_stage(
        "s",
        make_tasks(workdir, [1]),
        workdir / "out",
        "report",
        earlier_failures={"p0": "unreadable"},
    )
    assert read_failures(workdir / "out") == {"p0": "unreadable"}


def test_costs_stay_out_of_what_is_hashed(workdir):
    run_stage("s", make_tasks(workdir, [1]), workdir / "out", "strict")
    assert json.loads((workdir / "out" / "index.json").read_text()).keys() == {
        "schema",
        "step",
        "keys",
        "contents",
    }


@pytest.mark.parametrize(
    ("folder", "name"),
    [
        ("data/views", "views"),
        ("data/clouds/hull", "reconstruct"),
        ("data/states", "train"),
        ("data/weights/r2n2", "pretrain"),
    ],
)
def test_a_stage_that_was_not_run_is_named_as_dvc_has_it(tmp_path, folder, name):
    for read in (read_index, read_failures):
        with pytest.raises(BadArtifact, match=rf"{folder}/.* is missing\. `dvc repro {name}`"):
            read(tmp_path / folder)


def write_half(target, *, scratch, stop):
    """Leave a note; stop there, or go on from the note of an earlier call."""
    scratch.mkdir(parents=True, exist_ok=True)
    was_resumed = (scratch / "note").exists()
    time.sleep(0.2)
    (scratch / "note").write_text("half")
    if stop.exists():
        raise BadPart("stopped")
    (target / "resumed").write_text(str(was_resumed))


def test_what_is_resumable_goes_on_from_its_notes_and_leaves_none(workdir):
    stop = workdir / "stop"
    stop.touch()
    task = Task("p", partial(write_half, stop=stop), 0, (), resumable=True)
    start_time = time.monotonic()
    with pytest.raises(PartsFailed):
        run_stage("s", [task], workdir / "out", "strict")
    assert list((workdir / "store").glob("s/.resume-*/note"))
    stop.unlink()
    run_stage("s", [task], workdir / "out", "strict")
    assert (workdir / "out" / "p" / "resumed").read_text() == "True"
    (cost,) = (workdir / "store").glob("s/*/cost.json")
    # twice 0.2, but for the clocks' grain; and no attempt counts twice
    assert 0.39 < json.loads(cost.read_text())["seconds"] < time.monotonic() - start_time
    assert not list((workdir / "store").glob("s/.resume-*"))


def test_where_none_is_needed_all_may_fail(workdir):
    run_stage("s", make_tasks(workdir, [13]), workdir / "out", "report", needs_one=False)
    assert read_failures(workdir / "out") == {"p13": "thirteen"}
    with pytest.raises(PartsFailed):
        run_stage("s", make_tasks(workdir, [13]), workdir / "out", "report")
    with pytest.raises(PartsFailed):
        run_stage("s", make_tasks(workdir, [13]), workdir / "out", "strict", needs_one=False)


class LossyRunner:
    """A cluster that does the first piece of work and loses the others."""

    def map(self, works, limit_s, memory_mb=None):
        works[0]()
        yield WorkResult(0, None)
        yield from (WorkResult(i, "job 7 vanished", lost=True) for i in range(1, len(works)))


def test_what_the_cluster_lost_is_no_result(workdir, monkeypatch):
    """Else DVC would take the stage for done, and the report would blame the method."""
    monkeypatch.setattr(stage, "runner_from_environment", LossyRunner)
    message = r"(?s)1 of 2 parts failed.*p2: job 7 vanished.*give the same command again"
    with pytest.raises(PartsFailed, match=message):
        run_stage("s", make_tasks(workdir, [1, 2]), workdir / "out", "report")
    run_stage("s", make_tasks(workdir, [1, 2]), workdir / "out", "report")
    assert logged_calls(workdir) == ["1", "2"]


def test_what_a_full_disk_ended_is_no_result_and_made_once_there_is_room(workdir):
    """Else the part would count as a failure of the method, for good: DVC asks no second time."""
    (full := workdir / "full").touch()
    task = Task("p", partial(write_unless_full, full=full), 0, ())
    task_list = [*make_tasks(workdir, [1]), task]
    with pytest.raises(PartsFailed, match=r"(?s)No space left.*give the same command again"):
        run_stage("s", task_list, workdir / "out", "report")
    full.unlink()
    run_stage("s", task_list, workdir / "out", "report")
    assert read_failures(workdir / "out") == {}
    assert logged_calls(workdir) == ["1"]


@pytest.mark.parametrize(
    ("on_failure", "numbers", "advice"),
    [
        ("strict", [1, 13], "or set on_failure: report"),
        ("strict", [13], "choose other parts"),
        ("report", [13], "choose other parts"),
    ],
)
def test_advice_is_what_would_change_something(workdir, on_failure, numbers, advice):
    with pytest.raises(PartsFailed, match=advice):
        run_stage("s", make_tasks(workdir, numbers), workdir / "out", on_failure)


def test_where_not_all_failures_are_shown_it_says_where_they_are(workdir):
    failing = [
        replace(task, part_id=f"p{i}") for i in range(12) for task in make_tasks(workdir, [13])
    ]
    with pytest.raises(PartsFailed) as refusal:
        run_stage("s", failing, workdir / "out", "strict")
    message_lines = str(refusal.value).splitlines()
    assert message_lines[0].startswith("stage s: 12 of 12 parts failed")
    assert message_lines[-2] == f"  and 2 more: {workdir / 'out' / 'failures.json'}"
    assert sum(line.endswith("thirteen") for line in message_lines) == 10


def test_what_was_lost_is_said_however_much_failed_before(workdir, monkeypatch):
    monkeypatch.setattr(stage, "runner_from_environment", LossyRunner)
    earlier_failures = {f"a{i}": "no such file" for i in range(20)}
    with pytest.raises(PartsFailed, match="p2: job 7 vanished"):
        run_stage(
            "s",
            make_tasks(workdir, [1, 2]),
            workdir / "out",
            "report",
            earlier_failures=earlier_failures,
        )


def test_where_failures_are_losses_report_mode_does_not_end_well(workdir):
    with pytest.raises(PartsFailed, match=r"(?s)p13: thirteen.*1 were lost by .* a metric"):
        run_stage(
            "s",
            make_tasks(workdir, [1, 13]),
            workdir / "out",
            "report",
            failures_are_losses=True,
        )
    assert list(read_index(workdir / "out")) == ["p1"]


class RepeatingRunner:
    """A cluster that does everything again, as a job does that is requeued at the wrong moment."""

    def map(self, works, limit_s, memory_mb=None):
        for index, work in enumerate(works):
            work()
            work()
            yield WorkResult(index, None)


def test_what_is_in_the_store_by_the_time_its_turn_comes_is_not_made_again(workdir, monkeypatch):
    monkeypatch.setattr(stage, "runner_from_environment", RepeatingRunner)
    run_stage("s", make_tasks(workdir, [1, 2]), workdir / "out", "strict")
    assert logged_calls(workdir) == ["1", "2"]


def test_seconds_for_something_else_stand_aside(tmp_path):
    start = time.perf_counter()
    cost = stage.run_timed(partial(sleep_and_return, total_s=0.3, extra_s=0.25), tmp_path)
    total_s = time.perf_counter() - start
    assert cost.extra_seconds == 0.25
    # a sleep is never shorter, and what is left was measured inside of `total_s`; rounded to 1e-4
    assert 0.05 - 1e-4 <= cost.seconds <= total_s - 0.25 + 1e-4
    assert (
        stage.run_timed(
            partial(sleep_and_return, total_s=0.0, extra_s=None), tmp_path
        ).extra_seconds
        == 0
    )


def compute(target, *, child):
    """Take at least 0.2 processor seconds, in this process or in one that ends, and sleep 0.3 s."""
    code = "import time\nwhile time.process_time() < {}: pass"
    if child:
        subprocess.run([sys.executable, "-c", code.format(0.2)], check=True)
    else:
        exec(code.format(time.process_time() + 0.2))
    time.sleep(0.3)


@pytest.mark.parametrize("child", [False, True])
def test_processor_seconds_are_those_of_work_and_not_of_waiting(tmp_path, child):
    cost = stage.run_timed(partial(compute, child=child), tmp_path)
    assert cost.cpu_seconds >= 0.2 - 1e-4
    assert cost.cpu_seconds <= cost.seconds - 0.3 + 0.01  # one thread; the clock ticks every 4 ms
    assert cost.extra_cpu_seconds == 0.0


@pytest.mark.parametrize("tensors", [False, True])
@pytest.mark.parametrize("kernels", [False, True])
def test_a_cost_says_whether_a_gpu_was_used(tmp_path, monkeypatch, tensors, kernels):
    """By torch, or by Warp alone, as space carving does."""
    torch = SimpleNamespace(cuda=SimpleNamespace(is_initialized=lambda: tensors))
    gpus = [SimpleNamespace(has_context=False), SimpleNamespace(has_context=kernels)]
    monkeypatch.setitem(sys.modules, "torch", torch)
    monkeypatch.setitem(sys.modules, "warp", SimpleNamespace(get_cuda_devices=lambda: gpus))
    cost = stage.run_timed(partial(sleep_and_return, total_s=0.0, extra_s=None), tmp_path)
    assert cost.device == ("cuda" if tensors or kernels else "cpu")
