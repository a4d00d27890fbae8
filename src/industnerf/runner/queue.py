"""What SLURM says of jobs: `squeue` alone, for `sacct` needs a database that many do not have."""

import contextlib
import subprocess
from collections.abc import Iterable
from dataclasses import dataclass

# https://slurm.schedmd.com/squeue.html, job state codes
WAITING = {
    "PENDING",
    "CONFIGURING",
    "REQUEUED",
    "REQUEUE_FED",
    "REQUEUE_HOLD",
    "RESV_DEL_HOLD",
    "SPECIAL_EXIT",
}
WORKING = {"RUNNING", "RESIZING", "SIGNALING", "STAGE_OUT"}
STOPPED = {"COMPLETING", "SUSPENDED", "STOPPED"}  # may go on, or hang for ever
CANCELLED = "CANCELLED"
FORMAT = "%i|%T|%r"
ANSWER_S = 60.0  # a controller that takes longer is taken for one that does not answer


@dataclass(frozen=True)
class State:
    """The state of a job as SLURM names it, and why it is in it."""

    name: str
    reason: str = "None"

    @property
    def is_open(self) -> bool:
        """Whether the job may still do something."""
        return self.name in WAITING | WORKING | STOPPED

    @property
    def is_working(self) -> bool:
        return self.name in WORKING

    def __str__(self) -> str:
        return self.name if self.reason in ("None", "") else f"{self.name}, {self.reason}"


GONE = State("no longer known to squeue")


def parse(output: str) -> dict[str, State]:
    """Job id -> state, from lines of `squeue -h -r -o '%i|%T|%r'`."""
    rows = [line.strip().split("|", 2) for line in output.splitlines() if line.count("|") >= 2]
    return {job: State(name, reason) for job, name, reason in rows}


def ask(jobs: Iterable[str]) -> dict[str, State] | None:
    """The state of every one of `jobs`, or None where SLURM does not answer, or not in time.

    A job ended some time ago (MinJobAge) is known no more: GONE.
    """
    jobs = list(jobs)
    arrays = ",".join(sorted({job.partition("_")[0] for job in jobs}))
    command = ["squeue", "-h", "-r", "-t", "all", "-j", arrays, "-o", FORMAT]
    try:
        answer = subprocess.run(command, capture_output=True, text=True, timeout=ANSWER_S)
    except subprocess.TimeoutExpired:
        return None
    if answer.returncode and "Invalid job id" not in answer.stderr:
        return None
    states = parse(answer.stdout)
    return {job: states.get(job, GONE) for job in jobs}


def cancel(jobs: Iterable[str]) -> None:
    """Tell SLURM to end `jobs`; those that ended already do not matter."""
    with contextlib.suppress(subprocess.TimeoutExpired):
        subprocess.run(["scancel", "--quiet", *jobs], capture_output=True, timeout=ANSWER_S)
