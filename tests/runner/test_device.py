"""A device that is not there ends a stage before it begins."""

import pytest
import torch

from industnerf.device import device
from industnerf.errors import BadParams
from industnerf.runner.chunk import Chunk
from industnerf.runner.device import check_device
from industnerf.runner.job_status import JobStatus
from industnerf.stage import run_stage


@pytest.mark.parametrize("name", ["gpu", "cuda:", "cuda:x", "CPU", "cpu cuda"])
def test_what_names_no_device_is_refused_everywhere(name, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_DEVICE", name)
    for here in (True, False):
        with pytest.raises(BadParams, match="must be cpu, cuda or cuda:N"):
            check_device(here=here)


def test_a_gpu_that_is_not_here_may_be_elsewhere(monkeypatch):
    monkeypatch.setattr(torch.cuda, "device_count", lambda: 1)
    monkeypatch.setenv("INDUSTNERF_DEVICE", "cuda:0")
    check_device(here=True)
    monkeypatch.setenv("INDUSTNERF_DEVICE", "cuda:1")
    check_device(here=False)
    with pytest.raises(BadParams, match="torch finds 1 such devices here"):
        check_device(here=True)


def test_a_stage_ends_without_a_result(monkeypatch, tmp_path):
    monkeypatch.setenv("INDUSTNERF_DEVICE", "gpu")
    with pytest.raises(BadParams, match="INDUSTNERF_DEVICE is 'gpu'"):
        run_stage("train", [], tmp_path / "states", "report")
    assert not (tmp_path / "states").exists()


def test_on_a_node_without_it_a_job_ends_and_notes_no_failure(monkeypatch, tmp_path):
    monkeypatch.setattr(torch.cuda, "device_count", lambda: 0)
    monkeypatch.setenv("INDUSTNERF_DEVICE", "cuda")
    with pytest.raises(BadParams, match="torch finds 0"):
        Chunk(((0, print),), JobStatus(tmp_path), workers=1, limit_s=1.0, memory_mb=None)()
    assert JobStatus(tmp_path).started() == JobStatus(tmp_path).finished() == set()


@pytest.mark.parametrize("name", ["", "cpu"])
def test_without_a_gpu_tensors_live_on_the_processor(name, monkeypatch):
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    monkeypatch.setenv("INDUSTNERF_DEVICE", name)
    check_device(here=True)
    assert device() == torch.device("cpu")
