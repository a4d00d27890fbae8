"""NVIDIA Warp, which compiles our inner loops for CPU and CUDA alike: its start, and its arrays.

It is slow to import, so whoever may not need it does so late.
"""

import os
from typing import Any

import numpy as np
from jaxtyping import Float32, Int32

from industnerf import environment


def start() -> None:
    """Start Warp without its greeting, nor the complaint that there is no GPU: here is no need.

    The complaint is printed by the library itself, past Python's stderr.
    """
    import warp as wp

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
    import warp as wp

    name = environment.text("INDUSTNERF_DEVICE")
    if name or not wp.is_cuda_available():
        return name or "cpu"
    from industnerf.device import device

    return str(device())


def told(kernel: Any, cells: Int32[np.ndarray, "m"], *inputs: Any) -> Float32[np.ndarray, "m"]:
    """What `kernel` says of each of `cells`, given `inputs`."""
    import warp as wp

    said = wp.empty(len(cells), wp.float32, device=where())
    wp.launch(kernel, len(cells), [handed(cells, wp.int32), *inputs], [said], device=where())
    return said.numpy()


def handed(values: np.ndarray, dtype: type) -> Any:
    """As a Warp array where the kernels run: on a CPU the same memory, on a GPU a copy."""
    import warp as wp

    return wp.array(values, dtype=dtype, device=where(), copy=False)
