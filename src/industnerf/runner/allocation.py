"""What SLURM is asked for, and how it is waited for: INDUSTNERF_SLURM_*.

    PARTITION, ACCOUNT, GRES    as in sbatch; GRES for instance gpu:1
    CPUS            cores of a job, and pieces of work that it does at a time (1)
    MEMORY_MB       memory of a job (what the partition gives)
    MINUTES         time limit of a job (120); one that meets it is requeued and goes on
    JOBS            jobs that may run at a time (64)
    CHUNK           pieces of work in a job, at least (so many that every one of JOBS has four jobs
                    to do, one after the other)
    PATIENCE_MIN    give up when no job runs and nothing ends for so long (1440)
    POLL_S          ask the queue so often (10)
    FOLDER          logs, kept where something failed (.slurm)

Anything else goes by sbatch's own SBATCH_* variables: SBATCH_QOS, SBATCH_CONSTRAINT, ...
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from industnerf import environment
from industnerf.errors import BadParams

WARNING_S = 90  # before its time limit a job is told, and asks to be requeued
MIN_MINUTES = 5


@dataclass(frozen=True)
class Allocation:
    """What one job is given, and how many jobs run at a time."""

    partition: str | None
    account: str | None
    gres: str | None
    cpus: int
    memory_mb: int | None
    minutes: int
    jobs: int

    def sbatch_options(self) -> dict[str, Any]:
        """These, under the names of submitit."""
        optional = {
            "partition": self.partition,
            "account": self.account,
            "gres": self.gres,
            "mem": None if self.memory_mb is None else f"{self.memory_mb}M",
        }
        return {
            **{name: value for name, value in optional.items() if value is not None},
            "job_name": "industnerf",
            "cpus_per_task": self.cpus,
            # srun does not take this over from sbatch (since SLURM 22.05)
            "srun_args": [f"--cpus-per-task={self.cpus}"],
            "time": self.minutes,
            "array_parallelism": self.jobs,
            "signal_delay_s": WARNING_S,
            "additional_parameters": {"requeue": True},
        }


@dataclass(frozen=True)
class WaitSettings:
    """How work is dealt out, where the notes are, and how long to wait for them."""

    chunk: int | None
    patience_s: float
    poll_s: float
    folder: Path


def allocation_from_environment() -> Allocation:
    """What INDUSTNERF_SLURM_* ask of SLURM for a job.

    Raises BadParams for a value that is no number, or too few minutes.
    """
    minutes = _number("MINUTES", "minutes", 120)
    if minutes < MIN_MINUTES:
        raise BadParams(
            f"INDUSTNERF_SLURM_MINUTES is {minutes}, must be at least {MIN_MINUTES}: "
            f"a job is told of its end {WARNING_S} s before"
        )
    return Allocation(
        _text("PARTITION"),
        _text("ACCOUNT"),
        _text("GRES"),
        _number("CPUS", "cores of a job", 1),
        _number("MEMORY_MB", "megabytes", None),
        minutes,
        _number("JOBS", "jobs that may run at a time", 64),
    )


def wait_settings_from_environment() -> WaitSettings:
    """Raises BadParams for a value that is no number."""
    return WaitSettings(
        _number("CHUNK", "pieces of work in a job", None),
        _number("PATIENCE_MIN", "minutes", 1440) * 60.0,
        float(_number("POLL_S", "seconds", 10)),
        Path(_text("FOLDER") or ".slurm").absolute(),
    )


def _text(name: str) -> str | None:
    return environment.get_str(f"INDUSTNERF_SLURM_{name}")


def _number(name: str, what: str, default: int | None) -> Any:
    return environment.get_positive_int(f"INDUSTNERF_SLURM_{name}", what, default)
