"""A stage over all parts: reuse, failures, and what it writes."""

import errno
import json
import os
import sys
import time
from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import pytest

from industnerf import stage
from industnerf.errors import BadArtifact, BadPart, PartsFailed
from industnerf.runner import Outcome
from industnerf.stage import Task, read_failures, read_index, run_stage


def double(source, target, *, log):
    """Write twice the number in `source`; refuse 13.  Every call leaves a line in `log`."""
    number = int(source.read_text())
    with log.open("a") as file:
        file.write(f"{number}\n")
    if number == 13:
        raise BadPart("thirteen")
    (target / "twice").write_text(str(2 * number))


def store_on_a_disk(target, *, full):
    """Write, unless there is a file `full`."""
    if full.exists():
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(target))
    (target / "done").touch()


def linger(target, *, whole, aside):
    """Take `whole` seconds, `aside` of them for something else."""
    (target / "done").touch()
    time.sleep(whole)
    return aside


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_STORE", str(tmp_path / "store"))
    monkeypatch.setenv("INDUSTNERF_RUNNER", "serial")
    return tmp_path


def tasks(place, numbers, settings=0):
    for number in numbers:
        (place / f"in{number}").write_text(str(number))
    log = place / "log"
    return [
        Task(f"p{n}", partial(double, place / f"in{n}", log=log), settings, (place / f"in{n}",))
        for n in numbers
    ]


def calls(place):
    log = place / "log"
    made = log.read_text().split() if log.exists() else []
    log.unlink(missing_ok=True)
    return made


def test_finished_parts_are_reused(place):
    run_stage("s", tasks(place, [1, 2]), place / "out", "strict")
    assert calls(place) == ["1", "2"]
    run_stage("s", tasks(place, [1, 2, 3]), place / "out", "strict")
    assert calls(place) == ["3"]
    assert (place / "out" / "p1" / "twice").read_text() == "2"
    assert list(read_index(place / "out")) == ["p1", "p2", "p3"]


def test_changed_settings_are_made_anew(place):
    run_stage("s", tasks(place, [1], settings=0), place / "out", "strict")
    run_stage("s", tasks(place, [1], settings=1), place / "out", "strict")
    assert calls(place) == ["1", "1"]


def test_report_lists_a_failure_and_goes_on(place, capsys):
    run_stage("s", tasks(place, [1, 13, 2]), place / "out", "report")
    assert read_failures(place / "out") == {"p13": "thirteen"}
    assert list(read_index(place / "out")) == ["p1", "p2"]
    assert "p13 failed: thirteen" in capsys.readouterr().out


def test_failures_stand_in_one_order_whichever_part_ends_first(place, monkeypatch):
    class Backwards:
        def map(self, works, limit_s, memory_mb):
            return [Outcome(1, "late"), Outcome(0, "early")]

    monkeypatch.setattr(stage, "runner_from_environment", Backwards)
    run_stage("s", tasks(place, [1, 2]), place / "out", "report", needs_one=False)
    assert list(read_failures(place / "out")) == ["p1", "p2"]


def test_strict_ends_after_everything_else_is_stored(place):
    with pytest.raises(PartsFailed, match=r"(?s)1 of 3 parts failed.*p13: thirteen"):
        run_stage("s", tasks(place, [1, 13, 2]), place / "out", "strict")
    calls(place)
    with pytest.raises(PartsFailed):
        run_stage("s", tasks(place, [1, 13, 2]), place / "out", "strict")
    assert calls(place) == ["13"]


def test_a_stage_without_one_result_ends_even_in_report_mode(place):
    with pytest.raises(PartsFailed, match="1 of 1 parts failed"):
        run_stage("s", tasks(place, [13]), place / "out", "report")


def test_failures_of_earlier_stages_are_carried_on(place):
    run_stage("s", tasks(place, [1]), place / "out", "report", failed_before={"p0": "unreadable"})
    assert read_failures(place / "out") == {"p0": "unreadable"}


def test_costs_stay_out_of_what_is_hashed(place):
    run_stage("s", tasks(place, [1]), place / "out", "strict")
    assert json.loads((place / "out" / "index.json").read_text()).keys() == {
        "schema",
        "step",
        "keys",
    }


@pytest.mark.parametrize(
    ("folder", "name"),
    [
        ("data/views", "views"),
        ("data/clouds/hull", "reconstruct@hull"),
        ("data/states/r2n2", "train@r2n2"),
    ],
)
def test_a_stage_that_was_not_run_is_named_as_dvc_has_it(tmp_path, folder, name):
    for read in (read_index, read_failures):
        with pytest.raises(BadArtifact, match=rf"{folder}/.* is missing\. `dvc repro {name}`"):
            read(tmp_path / folder)


def half(target, *, scratch, stop):
    """Leave a note; stop there, or go on from the note of an earlier call."""
    scratch.mkdir(parents=True, exist_ok=True)
    before = (scratch / "note").exists()
    time.sleep(0.2)
    (scratch / "note").write_text("half")
    if stop.exists():
        raise BadPart("stopped")
    (target / "resumed").write_text(str(before))


def test_what_is_resumable_goes_on_from_its_notes_and_leaves_none(place):
    stop = place / "stop"
    stop.touch()
    task, begin = Task("p", partial(half, stop=stop), 0, (), resumable=True), time.monotonic()
    with pytest.raises(PartsFailed):
        run_stage("s", [task], place / "out", "strict")
    assert list((place / "store").glob("s/.resume-*/note"))
    stop.unlink()
    run_stage("s", [task], place / "out", "strict")
    assert (place / "out" / "p" / "resumed").read_text() == "True"
    (cost,) = (place / "store").glob("s/*/cost.json")
    # twice 0.2, but for the clocks' grain; and no attempt counts twice
    assert 0.39 < json.loads(cost.read_text())["seconds"] < time.monotonic() - begin
    assert not list((place / "store").glob("s/.resume-*"))


def test_where_none_is_needed_all_may_fail(place):
    run_stage("s", tasks(place, [13]), place / "out", "report", needs_one=False)
    assert read_failures(place / "out") == {"p13": "thirteen"}
    with pytest.raises(PartsFailed):
        run_stage("s", tasks(place, [13]), place / "out", "report")
    with pytest.raises(PartsFailed):
        run_stage("s", tasks(place, [13]), place / "out", "strict", needs_one=False)


class Lossy:
    """A cluster that does the first piece of work and loses the others."""

    def map(self, works, limit_s, memory_mb=None):
        works[0]()
        yield Outcome(0, None)
        yield from (Outcome(i, "job 7 vanished", lost=True) for i in range(1, len(works)))


def test_what_the_cluster_lost_is_no_result(place, monkeypatch):
    """Else DVC would take the stage for done, and the report would blame the method."""
    monkeypatch.setattr(stage, "runner_from_environment", Lossy)
    lost = r"(?s)1 of 2 parts failed.*p2: job 7 vanished.*give the same command again"
    with pytest.raises(PartsFailed, match=lost):
        run_stage("s", tasks(place, [1, 2]), place / "out", "report")
    run_stage("s", tasks(place, [1, 2]), place / "out", "report")
    assert calls(place) == ["1", "2"]


def test_what_a_full_disk_ended_is_no_result_and_made_once_there_is_room(place):
    """Else the part would count as a failure of the method, for good: DVC asks no second time."""
    (full := place / "full").touch()
    task = Task("p", partial(store_on_a_disk, full=full), 0, ())
    several = [*tasks(place, [1]), task]
    with pytest.raises(PartsFailed, match=r"(?s)No space left.*give the same command again"):
        run_stage("s", several, place / "out", "report")
    full.unlink()
    run_stage("s", several, place / "out", "report")
    assert read_failures(place / "out") == {}
    assert calls(place) == ["1"]


@pytest.mark.parametrize(
    ("on_failure", "numbers", "advice"),
    [
        ("strict", [1, 13], "or set on_failure: report"),
        ("strict", [13], "choose other parts"),
        ("report", [13], "choose other parts"),
    ],
)
def test_advice_is_what_would_change_something(place, on_failure, numbers, advice):
    with pytest.raises(PartsFailed, match=advice):
        run_stage("s", tasks(place, numbers), place / "out", on_failure)


def test_where_not_all_failures_are_shown_it_says_where_they_are(place):
    failing = [replace(task, part_id=f"p{i}") for i in range(12) for task in tasks(place, [13])]
    with pytest.raises(PartsFailed) as refused:
        run_stage("s", failing, place / "out", "strict")
    said = str(refused.value).splitlines()
    assert said[0].startswith("stage s: 12 of 12 parts failed")
    assert said[-2] == f"  and 2 more: {place / 'out' / 'failures.json'}"
    assert sum(line.endswith("thirteen") for line in said) == 10


def test_what_was_lost_is_said_however_much_failed_before(place, monkeypatch):
    monkeypatch.setattr(stage, "runner_from_environment", Lossy)
    before = {f"a{i}": "no such file" for i in range(20)}
    with pytest.raises(PartsFailed, match="p2: job 7 vanished"):
        run_stage("s", tasks(place, [1, 2]), place / "out", "report", failed_before=before)


class Twice:
    """A cluster that does everything again, as a job does that is requeued at the wrong moment."""

    def map(self, works, limit_s, memory_mb=None):
        for index, work in enumerate(works):
            work()
            work()
            yield Outcome(index, None)


def test_what_is_in_the_store_by_the_time_its_turn_comes_is_not_made_again(place, monkeypatch):
    monkeypatch.setattr(stage, "runner_from_environment", Twice)
    run_stage("s", tasks(place, [1, 2]), place / "out", "strict")
    assert calls(place) == ["1", "2"]


def test_seconds_for_something_else_stand_aside(tmp_path):
    start = time.perf_counter()
    cost = stage.measured(partial(linger, whole=0.3, aside=0.25), tmp_path)
    whole = time.perf_counter() - start
    assert cost.aside_s == 0.25
    # a sleep is never shorter, and what is left was measured inside of `whole`; rounded to 1e-4
    assert 0.05 - 1e-4 <= cost.seconds <= whole - 0.25 + 1e-4
    assert stage.measured(partial(linger, whole=0.0, aside=None), tmp_path).aside_s == 0


@pytest.mark.parametrize("tensors", [False, True])
@pytest.mark.parametrize("kernels", [False, True])
def test_a_cost_says_whether_a_gpu_was_used(tmp_path, monkeypatch, tensors, kernels):
    """By torch, or by Warp alone, as space carving does."""
    torch = SimpleNamespace(cuda=SimpleNamespace(is_initialized=lambda: tensors))
    gpus = [SimpleNamespace(has_context=False), SimpleNamespace(has_context=kernels)]
    monkeypatch.setitem(sys.modules, "torch", torch)
    monkeypatch.setitem(sys.modules, "warp", SimpleNamespace(get_cuda_devices=lambda: gpus))
    cost = stage.measured(partial(linger, whole=0.0, aside=None), tmp_path)
    assert cost.device == ("cuda" if tensors or kernels else "cpu")
