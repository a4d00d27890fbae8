"""Where tensors live: INDUSTNERF_DEVICE, or a GPU where there is one."""

import os

import torch


def device() -> torch.device:
    """The device of whatever is trained."""
    name = os.environ.get("INDUSTNERF_DEVICE")
    return torch.device(name or ("cuda" if torch.cuda.is_available() else "cpu"))
