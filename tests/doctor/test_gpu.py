"""A GPU: told of, missed where it is asked for, and behind a driver that fails."""

import os
import sys
from pathlib import Path

import pytest
import torch

from industnerf.doctor.gpu import UNSET_DEVICE
from tests.doctor.conftest import WorkingCopy, doctor

DRIVER_ERROR = "NVIDIA-SMI has failed because it couldn't communicate with the NVIDIA driver."
# what the real one does without its kernel module: a line on stdout, and this exit code
NVIDIA_SMI = f"""#!/bin/sh
echo "{DRIVER_ERROR}"
exit 9
"""


def broken_driver(folder: Path) -> str:
    """A PATH on which nvidia-smi is found, and fails."""
    (folder / "bin").mkdir()
    command = folder / "bin" / "nvidia-smi"
    command.write_text(NVIDIA_SMI)
    command.chmod(0o755)
    return f"{command.parent}{os.pathsep}{os.environ['PATH']}"


def test_it_is_told_of_and_not_missed_unless_asked_for(bare_copy: WorkingCopy):
    findings = bare_copy.check("gpu")
    assert [finding.is_error for finding in findings] == [False] * 3
    assert findings[1].message.startswith("torch ")
    assert findings[2].message.startswith("warp ")


def test_asked_for_in_vain_it_is_wrong_and_the_driver_is_quoted(bare_copy: WorkingCopy):
    """CUDA hides every device from torch, whether there is one or not."""
    variables = {"PATH": broken_driver(bare_copy.folder), "CUDA_VISIBLE_DEVICES": ""}
    command = ("-m", "industnerf.doctor", "gpu")
    code, output = doctor(bare_copy.folder, *command, INDUSTNERF_DEVICE="cuda", **variables)
    assert code == 1
    assert f"the driver fails: {DRIVER_ERROR}" in output
    assert "INDUSTNERF_DEVICE is 'cuda', but torch finds 0 such devices here" in output
    assert "1 thing is wrong\n" in output
    assert f"    mend: {UNSET_DEVICE}\n" in output


@pytest.mark.parametrize("environment", ["INDUSTNERF_DEVICE=cuda:98", ""])
def test_what_it_says_mends_it_though_a_file_names_the_device(
    bare_copy: WorkingCopy, environment: str
):
    (bare_copy.folder / ".industnerf.env").write_text("INDUSTNERF_DEVICE=cuda:99\n")
    command = (
        f"export INDUSTNERF_STORE=store {environment}; {sys.executable} -m industnerf.doctor gpu"
    )
    code, output = bare_copy.run(command)
    assert code == 1
    fix = output.split("    mend: ")[1].splitlines()[0]
    code, output = bare_copy.run(f"{fix}; {sys.executable} -m industnerf.doctor gpu")
    assert code == 0, output
    assert output.endswith("nothing is wrong\n")


def test_without_a_driver_there_is_no_nvidia_smi(bare_copy: WorkingCopy, monkeypatch):
    monkeypatch.setenv("PATH", str(bare_copy.folder))
    assert bare_copy.check("gpu")[0].message == "no NVIDIA driver (no nvidia-smi)"


def test_a_library_that_is_not_there_is_said_not_raised(bare_copy: WorkingCopy, monkeypatch):
    monkeypatch.setitem(sys.modules, "torch", None)  # as if it were not installed
    monkeypatch.setitem(sys.modules, "warp", None)
    monkeypatch.setenv("INDUSTNERF_DEVICE", "cuda")
    findings = bare_copy.check("gpu")
    assert [finding.is_error for finding in findings] == [False, False, False, True]
    for finding, name in zip(findings[1:3], ("torch", "warp"), strict=True):
        assert f"import of {name}" in finding.message
        assert "industnerf.doctor environment" in finding.message


@pytest.mark.skipif(not torch.cuda.is_available(), reason="no GPU that torch could see")
def test_a_gpu_that_is_there_is_seen_by_all_three(bare_copy: WorkingCopy):
    name = torch.cuda.get_device_name(0)
    assert all(name in finding.message for finding in bare_copy.check("gpu"))


def test_it_may_be_on_the_cluster_alone(bare_copy: WorkingCopy, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_DEVICE", "cuda:99")
    assert [finding.is_error for finding in bare_copy.check("gpu")][3:] == [True]
    monkeypatch.setenv("INDUSTNERF_RUNNER", "submitit")
    assert not any(finding.is_error for finding in bare_copy.check("gpu"))
