"""INDUSTNERF_* variables that are misspelt, or hold what no command takes."""

import os
import re
from pathlib import Path

import pytest

from industnerf.doctor.variables import KNOWN_VARIABLES, PREFIX
from tests.doctor.conftest import WorkingCopy, doctor

ROOT = Path(__file__).parents[2]
FAULTS = {
    "WORKES": ("2", "and does nothing; did you mean INDUSTNERF_WORKERS?"),
    "COLOR": ("red", "and does nothing; there are INDUSTNERF_DEBUG, "),
    "WORKERS": ("abc", "is 'abc', must be a number of processes, at least 1"),
    "SLURM_JOBS": ("0", "is '0', must be a number of jobs that may run at a time, at least 1"),
    "SLURM_MINUTES": ("3", "is 3, must be at least 5"),
    "SLURM_POLL_S": ("often", "is 'often', must be a number of seconds"),
    "DEVICE": ("gpu", "is 'gpu', must be cpu, cuda or cuda:N"),
    "RUNNER": ("slurm", "is 'slurm', must be process, serial or submitit"),
    "STORE": ("mine.txt/store", "mine.txt is no folder"),
    "MLFLOW": ("mine.txt", "mine.txt is no folder"),
}


@pytest.fixture(autouse=True)
def unset(monkeypatch):
    for name in os.environ:
        if name.startswith(PREFIX):
            monkeypatch.delenv(name)


@pytest.mark.parametrize("name", FAULTS)
def test_each_fault_is_said_and_taken_out_of_the_environment(
    bare_copy: WorkingCopy, name, monkeypatch
):
    value, message = FAULTS[name]
    (bare_copy.folder / "mine.txt").write_text("dear")
    monkeypatch.chdir(bare_copy.folder)
    monkeypatch.setenv(PREFIX + name, value)
    (finding,) = bare_copy.check("variables")
    assert message in finding.message
    assert finding.message.startswith(PREFIX + name)
    assert finding.fix == f"unset {PREFIX + name}"
    monkeypatch.delenv(PREFIX + name)
    assert bare_copy.check("variables") == []


def test_in_the_local_file_it_is_to_be_mended_there(bare_copy: WorkingCopy):
    (bare_copy.folder / ".industnerf.env").write_text("INDUSTNERF_WORKES=2\n")
    code, output = doctor(bare_copy.folder, "-m", "industnerf.doctor", "variables")
    assert code == 1
    assert ".industnerf.env: INDUSTNERF_WORKES is no variable" in output
    assert "mend" not in output


@pytest.mark.parametrize("line", ["# INDUSTNERF_DEVICE=gpu is gone", "INDUSTNERF_DEVICE=cpu"])
def test_the_environment_is_blamed_for_what_it_says_itself(
    bare_copy: WorkingCopy, line, monkeypatch
):
    """It wins over the file, whatever this says of the same name."""
    (bare_copy.folder / ".industnerf.env").write_text(f"{line}\n")
    monkeypatch.setenv(f"{PREFIX}DEVICE", "gpu")
    (finding,) = bare_copy.check("variables")
    assert finding.fix == f"unset {PREFIX}DEVICE"


def test_what_commands_take_is_right(bare_copy: WorkingCopy, monkeypatch):
    right = {"WORKERS": "2", "DEVICE": "cuda:1", "RUNNER": "serial", "MLFLOW": "off", "STORE": ""}
    for name, value in right.items():
        monkeypatch.setenv(PREFIX + name, value)
    assert bare_copy.check("variables") == []


def test_every_variable_that_the_suite_reads_is_known():
    files = [*ROOT.glob("src/**/*.py"), *ROOT.glob("pipeline/*.py")]
    text = "\n".join(path.read_text() for path in files)
    mentioned = set(re.findall(r"INDUSTNERF_[A-Z_]*[A-Z]\b(?!_)", text)) - {"INDUSTNERF_SLURM"}
    of_slurm = re.search(r'"""What SLURM is asked for.*?"""', text, re.DOTALL)[0]
    listed = {
        f"INDUSTNERF_SLURM_{name}"
        for line in re.findall(r"^    ([A-Z][A-Z_, ]+?)  ", of_slurm, re.MULTILINE)
        for name in line.split(", ")
    }
    assert listed >= {"INDUSTNERF_SLURM_GRES", "INDUSTNERF_SLURM_FOLDER"}
    assert mentioned | listed == set(KNOWN_VARIABLES)
