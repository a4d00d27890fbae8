"""What SLURM says of jobs: `squeue` alone, for `sacct` needs a database that many do not have."""

import contextlib
import subprocess
from collections.abc import Iterable
from dataclasses import dataclass

# https://slurm.schedmd.com/squeue.html, job state codes
WAITING_STATES = {
    "PENDING",
    "CONFIGURING",
    "REQUEUED",
    "REQUEUE_FED",
    "REQUEUE_HOLD",
    "RESV_DEL_HOLD",
    "SPECIAL_EXIT",
}
WORKING_STATES = {"RUNNING", "RESIZING", "SIGNALING", "STAGE_OUT"}
STOPPED_STATES = {"COMPLETING", "SUSPENDED", "STOPPED"}  # may go on, or hang for ever
CANCELLED = "CANCELLED"
FORMAT = "%i|%T|%r"
TIMEOUT_S = 60.0  # a controller that takes longer is taken for one that does not answer


@dataclass(frozen=True)
class JobState:
    """The state of a job as SLURM names it, and why it is in it."""

    name: str
    reason: str = "None"

    @property
    def is_open(self) -> bool:
        """Whether the job may still do something."""
        return self.name in WAITING_STATES | WORKING_STATES | STOPPED_STATES

    @property
    def is_working(self) -> bool:
        return self.name in WORKING_STATES

    def __str__(self) -> str:
        return self.name if self.reason in ("None", "") else f"{self.name}, {self.reason}"


GONE = JobState("no longer known to squeue")


def parse_states(output: str) -> dict[str, JobState]:
    """Job id -> state, from lines of `squeue -h -r -o '%i|%T|%r'`."""
    rows = [line.strip().split("|", 2) for line in output.splitlines() if line.count("|") >= 2]
    return {job: JobState(name, reason) for job, name, reason in rows}


def query_states(jobs: Iterable[str]) -> dict[str, JobState] | None:
    """The state of every one of `jobs`, or None where SLURM does not answer, or not in time.

    A job ended some time ago (MinJobAge) is known no more: GONE.
    """
    jobs = list(jobs)
    arrays = ",".join(sorted({job.partition("_")[0] for job in jobs}))
    command = ["squeue", "-h", "-r", "-t", "all", "-j", arrays, "-o", FORMAT]
    try:
        output = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT_S)
    except subprocess.TimeoutExpired:
        return None
    if output.returncode and "Invalid job id" not in output.stderr:
        return None
    states = parse_states(output.stdout)
    return {job: states.get(job, GONE) for job in jobs}


def cancel_jobs(jobs: Iterable[str]) -> None:
    """Tell SLURM to end `jobs`; those that ended already do not matter."""
    with contextlib.suppress(subprocess.TimeoutExpired):
        subprocess.run(["scancel", "--quiet", *jobs], capture_output=True, timeout=TIMEOUT_S)
