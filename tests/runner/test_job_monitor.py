"""Waiting for jobs, with a queue and a clock of the tests' own."""

import pytest

from industnerf.runner import WorkResult
from industnerf.runner.job_monitor import JobMonitor
from industnerf.runner.job_status import JobStatus
from industnerf.runner.queue import GONE, JobState

RUNNING, PENDING, FAILED = JobState("RUNNING"), JobState("PENDING", "Resources"), JobState("FAILED")


class FakeQueue:
    """What happens at each look at the queue: states, pieces that end, pieces that begin."""

    def __init__(self, folder, *steps):
        self.status, self.steps, self.time = JobStatus(folder), list(steps), 0.0

    def query_states(self, jobs):
        states, finished, started = self.steps.pop(0) if len(self.steps) > 1 else self.steps[0]
        for index in finished:
            self.status.write(WorkResult(index, None))
        for index in started:
            self.status.run(index, lambda: None)
        return None if states is None else {job: states[job] for job in jobs}

    def sleep(self, seconds):
        self.time += seconds

    def monitor(self, jobs, patience_s=60.0):
        logs = dict.fromkeys(jobs, self.status.folder / "log")
        return JobMonitor(
            jobs,
            self.status,
            logs,
            self.query_states,
            10.0,
            patience_s,
            self.sleep,
            lambda: self.time,
        )


@pytest.fixture
def fake_queue(tmp_path):
    return lambda *looks: FakeQueue(tmp_path, *looks)


def test_what_a_job_noted_counts_whatever_slurm_thinks_of_it(fake_queue):
    queue = fake_queue(({"1": PENDING}, [0], []), ({"1": GONE}, [1], []))
    monitor = queue.monitor({"1": {0, 1}})
    assert list(monitor.results()) == [WorkResult(0, None), WorkResult(1, None)]
    assert queue.time == 10.0


def test_a_job_that_died_fails_what_it_was_at_and_leaves_the_rest(fake_queue):
    monitor = fake_queue(
        ({"1": FAILED, "2": RUNNING}, [], [0]), ({"1": FAILED, "2": RUNNING}, [3], [])
    ).monitor({"1": {0, 1, 2}, "2": {3}})
    first, second = monitor.results()
    assert first == WorkResult(3, None)
    assert second.index == 0
    assert second.lost
    assert second.error == "SLURM job 1 ended without a result: FAILED; it wrote no log"
    assert monitor.unstarted == [1, 2]
    assert not monitor.abandoned


@pytest.mark.parametrize(
    ("state", "started"), [(JobState("CANCELLED"), [0]), (FAILED, []), (GONE, [])]
)
def test_what_was_cancelled_or_never_began_is_not_tried_again(fake_queue, state, started):
    monitor = fake_queue(({"1": state}, [], started)).monitor({"1": {0, 1}})
    assert [result.index for result in monitor.results()] == [0, 1]
    assert monitor.unstarted == []


def test_the_last_note_of_a_job_may_come_late(fake_queue):
    monitor = fake_queue(({"1": FAILED}, [], [0]), ({"1": FAILED}, [0], [])).monitor({"1": {0}})
    assert list(monitor.results()) == [WorkResult(0, None)]


def test_a_requeued_job_is_waited_for(fake_queue):
    monitor = fake_queue(
        ({"1": FAILED}, [], [0]),
        ({"1": PENDING}, [], []),
        ({"1": FAILED}, [], []),
        ({"1": RUNNING}, [0], []),
    ).monitor({"1": {0}})
    assert list(monitor.results()) == [WorkResult(0, None)]


@pytest.mark.parametrize(
    ("states", "state_text"),
    [
        ({"1": PENDING}, "PENDING, Resources"),
        ({"1": JobState("COMPLETING")}, "COMPLETING"),
        (None, "squeue does not answer"),
    ],
)
def test_without_news_jobs_are_given_up(fake_queue, states, state_text):
    queue = fake_queue((states, [], []))
    monitor = queue.monitor({"1": {0, 1}})
    results = list(monitor.results())
    assert [result.index for result in results] == [0, 1]
    reason = "nothing heard for 1 min (INDUSTNERF_SLURM_PATIENCE_MIN)"
    assert results[0].error == f"SLURM job 1: {reason}: {state_text}; it wrote no log"
    assert results[0].lost
    assert queue.time == 60.0
    assert monitor.abandoned == ["1"]


def test_patience_begins_anew_with_every_job_that_works(fake_queue):
    queue = fake_queue(*[({"1": RUNNING}, [], [])] * 20, ({"1": PENDING}, [], []))
    assert len(list(queue.monitor({"1": {0}}).results())) == 1
    assert queue.time == 19 * 10.0 + 60.0
