"""Waiting for jobs, with a queue and a clock of the tests' own."""

import pytest

from industnerf.runner import Outcome
from industnerf.runner.notes import Notes
from industnerf.runner.queue import GONE, State
from industnerf.runner.watch import Watch

RUNNING, PENDING, FAILED = State("RUNNING"), State("PENDING", "Resources"), State("FAILED")


class Story:
    """What happens at each look at the queue: states, pieces that end, pieces that begin."""

    def __init__(self, folder, *looks):
        self.notes, self.looks, self.time = Notes(folder), list(looks), 0.0

    def queue(self, jobs):
        states, ended, begun = self.looks.pop(0) if len(self.looks) > 1 else self.looks[0]
        for index in ended:
            self.notes.write(Outcome(index, None))
        for index in begun:
            self.notes.begin(index, lambda: None)
        return None if states is None else {job: states[job] for job in jobs}

    def sleep(self, seconds):
        self.time += seconds

    def watch(self, jobs, patience_s=60.0):
        logs = dict.fromkeys(jobs, self.notes.folder / "log")
        return Watch(
            jobs, self.notes, logs, self.queue, 10.0, patience_s, self.sleep, lambda: self.time
        )


@pytest.fixture
def story(tmp_path):
    return lambda *looks: Story(tmp_path, *looks)


def test_what_a_job_noted_counts_whatever_slurm_thinks_of_it(story):
    told = story(({"1": PENDING}, [0], []), ({"1": GONE}, [1], []))
    watch = told.watch({"1": {0, 1}})
    assert list(watch.outcomes()) == [Outcome(0, None), Outcome(1, None)]
    assert told.time == 10.0


def test_a_job_that_died_fails_what_it_was_at_and_leaves_the_rest(story):
    watch = story(
        ({"1": FAILED, "2": RUNNING}, [], [0]), ({"1": FAILED, "2": RUNNING}, [3], [])
    ).watch({"1": {0, 1, 2}, "2": {3}})
    first, second = watch.outcomes()
    assert first == Outcome(3, None)
    assert second.index == 0
    assert second.lost
    assert second.error == "SLURM job 1 ended without a result: FAILED; it wrote no log"
    assert watch.orphans == [1, 2]
    assert not watch.hopeless


@pytest.mark.parametrize(("state", "begun"), [(State("CANCELLED"), [0]), (FAILED, []), (GONE, [])])
def test_what_was_cancelled_or_never_began_is_not_tried_again(story, state, begun):
    watch = story(({"1": state}, [], begun)).watch({"1": {0, 1}})
    assert [outcome.index for outcome in watch.outcomes()] == [0, 1]
    assert watch.orphans == []


def test_the_last_note_of_a_job_may_come_late(story):
    watch = story(({"1": FAILED}, [], [0]), ({"1": FAILED}, [0], [])).watch({"1": {0}})
    assert list(watch.outcomes()) == [Outcome(0, None)]


def test_a_requeued_job_is_waited_for(story):
    watch = story(
        ({"1": FAILED}, [], [0]),
        ({"1": PENDING}, [], []),
        ({"1": FAILED}, [], []),
        ({"1": RUNNING}, [0], []),
    ).watch({"1": {0}})
    assert list(watch.outcomes()) == [Outcome(0, None)]


@pytest.mark.parametrize(
    ("states", "said"),
    [
        ({"1": PENDING}, "PENDING, Resources"),
        ({"1": State("COMPLETING")}, "COMPLETING"),
        (None, "squeue does not answer"),
    ],
)
def test_without_news_jobs_are_given_up(story, states, said):
    told = story((states, [], []))
    watch = told.watch({"1": {0, 1}})
    outcomes = list(watch.outcomes())
    assert [outcome.index for outcome in outcomes] == [0, 1]
    why = "nothing heard for 1 min (INDUSTNERF_SLURM_PATIENCE_MIN)"
    assert outcomes[0].error == f"SLURM job 1: {why}: {said}; it wrote no log"
    assert outcomes[0].lost
    assert told.time == 60.0
    assert watch.hopeless == ["1"]


def test_patience_begins_anew_with_every_job_that_works(story):
    told = story(*[({"1": RUNNING}, [], [])] * 20, ({"1": PENDING}, [], []))
    assert len(list(told.watch({"1": {0}}).outcomes())) == 1
    assert told.time == 19 * 10.0 + 60.0
