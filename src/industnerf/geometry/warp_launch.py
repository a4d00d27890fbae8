"""Launching compiled kernels over cells.

NVIDIA Warp is slow to import, so it is imported late.
"""

from typing import Any

import numpy as np
from jaxtyping import Float32, Int32

from industnerf import environment


def warp_device() -> str:
    """The device of `device.device`; torch, slow to import, is loaded only if Warp sees a GPU."""
    import warp as wp

    name = environment.get_str("INDUSTNERF_DEVICE")
    if name or not wp.is_cuda_available():
        return name or "cpu"
    from industnerf.device import device

    return str(device())


def launch(kernel: Any, cells: Int32[np.ndarray, "m"], *inputs: Any) -> Float32[np.ndarray, "m"]:
    """The value that `kernel` computes for each of `cells`, given `inputs`."""
    import warp as wp

    output = wp.empty(len(cells), wp.float32, device=warp_device())
    wp.launch(
        kernel, len(cells), [to_warp(cells, wp.int32), *inputs], [output], device=warp_device()
    )
    return output.numpy()


def to_warp(values: np.ndarray, dtype: type) -> Any:
    """As a Warp array where the kernels run: on a CPU the same memory, on a GPU a copy."""
    import warp as wp

    return wp.array(values, dtype=dtype, device=warp_device(), copy=False)
