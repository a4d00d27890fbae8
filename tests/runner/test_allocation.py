"""What is asked of SLURM, from the environment."""

import shutil

import pytest

from industnerf.errors import BadParams
from industnerf.runner import runner_from_environment, slurm
from industnerf.runner.allocation import allocation_from_environment, wait_settings_from_environment


@pytest.fixture
def set_slurm(monkeypatch):
    """Sets INDUSTNERF_SLURM_*."""

    def set_variables(**values):
        for name, value in values.items():
            monkeypatch.setenv(f"INDUSTNERF_SLURM_{name}", value)

    return set_variables


def test_a_gpu_is_asked_for_as_sbatch_wants_it(set_slurm):
    set_slurm(PARTITION="gpu", GRES="gpu:1", CPUS="4", MEMORY_MB="8000", MINUTES="90", JOBS="8")
    options = allocation_from_environment().sbatch_options()
    assert (options["partition"], options["gres"], options["mem"]) == ("gpu", "gpu:1", "8000M")
    assert (options["time"], options["array_parallelism"], options["cpus_per_task"]) == (90, 8, 4)
    assert "--cpus-per-task=4" in options["srun_args"]
    assert "account" not in options


@pytest.mark.parametrize("name", ["CPUS", "MEMORY_MB", "MINUTES", "JOBS"])
def test_a_job_is_not_asked_for_with_nonsense(set_slurm, name):
    set_slurm(**{name: "some"})
    with pytest.raises(BadParams, match=f"INDUSTNERF_SLURM_{name} is 'some', must be a number of"):
        allocation_from_environment()


@pytest.mark.parametrize("name", ["CHUNK", "PATIENCE_MIN", "POLL_S"])
def test_nor_is_it_waited_for(set_slurm, name):
    set_slurm(**{name: "0"})
    with pytest.raises(BadParams, match=f"INDUSTNERF_SLURM_{name} is '0', must be a number of"):
        wait_settings_from_environment()


def test_a_job_must_last_until_it_can_be_told_of_its_end(set_slurm):
    set_slurm(MINUTES="1")
    with pytest.raises(BadParams, match="INDUSTNERF_SLURM_MINUTES is 1, must be at least 5"):
        allocation_from_environment()


def test_a_piece_of_work_must_fit_into_a_job(set_slurm):
    set_slurm(MINUTES="60")
    runner = slurm.SlurmRunner(allocation_from_environment(), wait_settings_from_environment())
    with pytest.raises(BadParams, match=r"may take 3600 s .* raise INDUSTNERF_SLURM_MINUTES"):
        list(runner.map([], 3600.0))
    assert list(runner.map([], 3510.0)) == []


def test_without_submitit_it_is_said_how_to_install_it(monkeypatch):
    monkeypatch.setenv("INDUSTNERF_RUNNER", "submitit")
    monkeypatch.setattr(slurm, "find_spec", lambda name: None)
    with pytest.raises(BadParams, match=r"pip install -e '\.\[slurm\]'"):
        runner_from_environment()


def test_without_slurm_it_is_said_what_is_missing(monkeypatch):
    monkeypatch.setenv("INDUSTNERF_RUNNER", "submitit")
    monkeypatch.setattr(shutil, "which", lambda name: None if name == "squeue" else name)
    with pytest.raises(BadParams, match="needs squeue of SLURM, not found here"):
        runner_from_environment()
