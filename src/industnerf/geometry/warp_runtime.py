"""NVIDIA Warp, which compiles our inner loops for CPU and CUDA alike, started silently."""

import os
import platform

import numpy as np
import warp as wp

from industnerf import processor

# Whatever the processor is, kernels are compiled for the same one; the rest is Warp's default.
CPU_FLAGS = (
    f"-target-cpu {processor.ISA} -mllvm=-inline-threshold=9000"
    " -mllvm=-inline-cold-callsite-threshold=3000 -mllvm=-slp-recursion-max-depth=4"
)

mat34 = wp.types.matrix(shape=(3, 4), dtype=wp.float32)  # from a point to its pixel


def init_warp() -> None:
    """Start Warp without its banner and without its warning that there is no GPU.

    The warning is printed by the library itself, past Python's stderr.
    """
    wp.config.log_level = wp.LOG_ERROR
    if platform.machine() in ("x86_64", "AMD64"):
        wp.config.cpu_compiler_flags = CPU_FLAGS
    stderr_copy = os.dup(2)
    with open(os.devnull, "w") as devnull:
        os.dup2(devnull.fileno(), 2)
        try:
            wp.init()
        finally:
            os.dup2(stderr_copy, 2)
            os.close(stderr_copy)


def on_cpu(values: np.ndarray) -> wp.array:
    """The same memory for a kernel that runs on the CPU, flat."""
    dtype = wp.dtype_from_numpy(values.dtype)
    return wp.array(values.reshape(-1), dtype=dtype, device="cpu", copy=False)
