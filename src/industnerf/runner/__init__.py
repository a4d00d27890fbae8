"""Where work on parts is executed.  The result of a piece of work is what it put in the store.

`Runner.map` is the whole interface.  How to execute comes from the environment or .industnerf.env,
never from params.yaml, and never changes a result:

    INDUSTNERF_RUNNER    process (default), serial, or submitit: SLURM, see `slurm.py`
    INDUSTNERF_WORKERS   number of processes; default: the cores this process may use
    INDUSTNERF_DEVICE    cpu, cuda or cuda:1; default: a GPU where there is one
"""

import os

from industnerf import environment
from industnerf.errors import BadParams
from industnerf.runner.base import GroupedWork, Runner, WorkItem, WorkResult
from industnerf.runner.device import check_device
from industnerf.runner.processes import ProcessRunner, SerialRunner, die_with_parent

__all__ = [
    "GroupedWork",
    "ProcessRunner",
    "Runner",
    "SerialRunner",
    "WorkItem",
    "WorkResult",
    "die_with_parent",
    "runner_from_environment",
]


RUNNERS = ("process", "serial", "submitit")


def runner_from_environment() -> Runner:
    """The runner that INDUSTNERF_RUNNER names.

    Raises BadParams for an unknown one, and for a device that INDUSTNERF_DEVICE names and this
    machine lacks.
    """
    name = runner_name()
    check_device(here=name != "submitit")
    if name == "serial":
        return SerialRunner()
    if name == "process":
        cores = len(os.sched_getaffinity(0))
        return ProcessRunner(worker_count() or cores)
    from industnerf.runner.slurm import slurm_from_environment

    return slurm_from_environment()


def worker_count() -> int | None:
    """How many processes INDUSTNERF_WORKERS asks for; raises BadParams if that is no number."""
    return environment.get_positive_int("INDUSTNERF_WORKERS", "processes")


def runner_name() -> str:
    """What INDUSTNERF_RUNNER names; raises BadParams for an unknown one."""
    name = environment.get_str("INDUSTNERF_RUNNER") or "process"
    if name not in RUNNERS:
        raise BadParams(f"INDUSTNERF_RUNNER is {name!r}, must be process, serial or submitit")
    return name
