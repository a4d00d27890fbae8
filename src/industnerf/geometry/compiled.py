"""NVIDIA Warp, which compiles our inner loops for CPU and CUDA alike, started in silence."""

import os

import warp as wp

from industnerf import environment

mat34 = wp.types.matrix(shape=(3, 4), dtype=wp.float32)  # from a place to its pixel


def start() -> None:
    """Start Warp without its greeting, nor the complaint that there is no GPU: here is no need.

    The complaint is printed by the library itself, past Python's stderr.
    """
    wp.config.log_level = wp.LOG_ERROR
    kept = os.dup(2)
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 2)
        try:
            wp.init()
        finally:
            os.dup2(kept, 2)
            os.close(kept)


def where() -> str:
    """What `device.device` says; torch, slow to import, is asked only where Warp sees a GPU."""
    name = environment.text("INDUSTNERF_DEVICE")
    if name or not wp.is_cuda_available():
        return name or "cpu"
    from industnerf.device import device

    return str(device())
