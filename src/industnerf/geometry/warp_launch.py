"""Launching compiled kernels over cells.

NVIDIA Warp is slow to import, so it is imported late.
"""

from typing import Any

import numpy as np
from jaxtyping import Float32, Int32


def launch(kernel: Any, cells: Int32[np.ndarray, "m"], *inputs: Any) -> Float32[np.ndarray, "m"]:
    """The value that `kernel` computes for each of `cells`, given `inputs`."""
    import warp as wp

    from industnerf.geometry.warp_runtime import warp_device

    output = wp.empty(len(cells), wp.float32, device=warp_device())
    wp.launch(
        kernel, len(cells), [to_warp(cells, wp.int32), *inputs], [output], device=warp_device()
    )
    return output.numpy()


def to_warp(values: np.ndarray, dtype: type) -> Any:
    """As a Warp array where the kernels run: on a CPU the same memory, on a GPU a copy."""
    import warp as wp

    from industnerf.geometry.warp_runtime import warp_device

    return wp.array(values, dtype=dtype, device=warp_device(), copy=False)
