"""NVIDIA Warp, which compiles our inner loops for CPU and CUDA alike, started silently."""

import os

import warp as wp

from industnerf import environment

mat34 = wp.types.matrix(shape=(3, 4), dtype=wp.float32)  # from a point to its pixel


def init_warp() -> None:
    """Start Warp without its banner and without its warning that there is no GPU.

    The warning is printed by the library itself, past Python's stderr.
    """
    wp.config.log_level = wp.LOG_ERROR
    stderr_copy = os.dup(2)
    with open(os.devnull, "w") as devnull:
        os.dup2(devnull.fileno(), 2)
        try:
            wp.init()
        finally:
            os.dup2(stderr_copy, 2)
            os.close(stderr_copy)


def warp_device() -> str:
    """What `device.device` says; torch, slow to import, is asked only where Warp sees a GPU."""
    name = environment.get_str("INDUSTNERF_DEVICE")
    if name or not wp.is_cuda_available():
        return name or "cpu"
    from industnerf.device import device

    return str(device())
