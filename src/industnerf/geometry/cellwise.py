"""Asking compiled kernels about cells.

NVIDIA Warp is slow to import, so whoever may not need it does so late.
"""

from typing import Any

import numpy as np
from jaxtyping import Float32, Int32


def told(kernel: Any, cells: Int32[np.ndarray, "m"], *inputs: Any) -> Float32[np.ndarray, "m"]:
    """What `kernel` says of each of `cells`, given `inputs`."""
    import warp as wp

    from industnerf.geometry.compiled import where

    said = wp.empty(len(cells), wp.float32, device=where())
    wp.launch(kernel, len(cells), [handed(cells, wp.int32), *inputs], [said], device=where())
    return said.numpy()


def handed(values: np.ndarray, dtype: type) -> Any:
    """As a Warp array where the kernels run: on a CPU the same memory, on a GPU a copy."""
    import warp as wp

    from industnerf.geometry.compiled import where

    return wp.array(values, dtype=dtype, device=where(), copy=False)
