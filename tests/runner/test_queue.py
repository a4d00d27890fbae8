"""What squeue prints, and what it means that it says nothing."""

import subprocess
import time

import pytest

from industnerf.runner import queue
from industnerf.runner.queue import GONE, JobState

PRINTED = """\
          12_0|RUNNING|None
12_1|PENDING|JobArrayTaskLimit
12_2|CANCELLED|None
12_3|PENDING|launch failed|requeued held
slurm_load_jobs: a warning of some site
"""


def test_every_job_has_its_state_and_why():
    states = queue.parse_states(PRINTED)
    assert states["12_0"] == JobState("RUNNING")
    assert states["12_1"] == JobState("PENDING", "JobArrayTaskLimit")
    assert states["12_3"].reason == "launch failed|requeued held"
    assert len(states) == 4
    assert [str(states[f"12_{i}"]) for i in (0, 1)] == ["RUNNING", "PENDING, JobArrayTaskLimit"]


@pytest.mark.parametrize(
    ("name", "is_open", "is_working"),
    [
        ("PENDING", True, False),
        ("REQUEUED", True, False),
        ("RESV_DEL_HOLD", True, False),
        ("RUNNING", True, True),
        ("COMPLETING", True, False),
        ("COMPLETED", False, False),
        ("CANCELLED", False, False),
        ("OUT_OF_MEMORY", False, False),
        ("NODE_FAIL", False, False),
        (GONE.name, False, False),
    ],
)
def test_which_states_are_worth_waiting_for(name, is_open, is_working):
    assert (JobState(name).is_open, JobState(name).is_working) == (is_open, is_working)


@pytest.fixture
def squeue(monkeypatch):
    """Makes squeue answer as given, and keeps what it was asked."""
    commands = []

    def set_output(output="", error="", code=0):
        def run(command, **_):
            commands.append(command)
            return subprocess.CompletedProcess(command, code, output, error)

        monkeypatch.setattr(subprocess, "run", run)
        return commands

    return set_output


def test_an_array_is_asked_for_once(squeue):
    commands = squeue(PRINTED)
    assert queue.query_states(["12_0", "12_1", "7"]) == {
        "12_0": JobState("RUNNING"),
        "12_1": JobState("PENDING", "JobArrayTaskLimit"),
        "7": GONE,
    }
    assert commands[0][commands[0].index("-j") + 1] == "12,7"


def test_a_job_that_squeue_has_forgotten_is_gone(squeue):
    squeue(error="slurm_load_jobs error: Invalid job id specified", code=1)
    assert queue.query_states(["12_0"]) == {"12_0": GONE}


def test_a_controller_that_does_not_answer_says_nothing_of_a_job(squeue):
    squeue(error="slurm_load_jobs error: Unable to contact slurm controller", code=1)
    assert queue.query_states(["12_0"]) is None


def test_nor_does_one_that_hangs(monkeypatch, tmp_path):
    for name in ("squeue", "scancel"):
        (tmp_path / name).write_text("#!/bin/sh\nexec sleep 60\n")
        (tmp_path / name).chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    monkeypatch.setattr(queue, "TIMEOUT_S", 0.2)
    start = time.monotonic()
    assert queue.query_states(["12_0"]) is None
    queue.cancel_jobs(["12_0"])
    assert time.monotonic() - start < 30
