"""Where compiled kernels run that need no tensors."""

import pytest
import torch
import warp as wp

from industnerf.geometry.warp_launch import warp_device


@pytest.mark.parametrize("name", ["cpu", "cuda", "cuda:1"])
def test_the_environment_says_where(monkeypatch, name):
    monkeypatch.setenv("INDUSTNERF_DEVICE", name)
    assert warp_device() == name


@pytest.mark.parametrize("warps", [False, True])
@pytest.mark.parametrize("torchs", [False, True])
def test_on_a_gpu_only_if_both_see_one(monkeypatch, warps, torchs):
    """Else half of a method would run here and half of it there."""
    monkeypatch.delenv("INDUSTNERF_DEVICE", raising=False)
    monkeypatch.setattr(wp, "is_cuda_available", lambda: warps)
    monkeypatch.setattr(torch.cuda, "is_available", lambda: torchs)
    assert warp_device() == ("cuda" if warps and torchs else "cpu")
