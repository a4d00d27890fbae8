"""Kernels of torch on the CPU that do not depend on who made the processor.

torch leaves matrix products and square roots to Intel's MKL.  Its products add in another order on
each make of processor, and on all alike only in a mode of half the speed; numpy's OpenBLAS takes a
kernel by name (`industnerf.processor`), and is as fast.  Its roots begin with the processor's
approximation of 1/sqrt, which is not the same for all makes; those of the processor are exact.
"""

import warnings
from functools import cache

import numpy as np
import torch
from torch import Tensor

from industnerf import processor


def use_reproducible_kernels(threads: int = 1) -> None:
    """From here on torch computes with `threads` threads, the same bytes on every x86-64 CPU.

    Warns where numpy or torch was loaded before `industnerf`: then they are this processor's.
    """
    if late := processor.unpinned_libraries():
        warnings.warn(
            f"{' and '.join(late)} came before industnerf and chose kernels by this processor: "
            "another gives other bytes; import industnerf first",
            RuntimeWarning,
            stacklevel=2,
        )
    torch.set_num_threads(threads)
    register_kernels()


@cache
def register_kernels() -> torch.library.Library:
    library = torch.library.Library("aten", "IMPL")
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="(?s).*overrid")
        for name, kernel in {
            "mm": _matmul,
            "bmm": _matmul,
            "addmm": _addmm,
            "baddbmm": _addmm,
            "sqrt": _sqrt,
            "sqrt_": _sqrt_in_place,
        }.items():
            library.impl(name, kernel, "CPU")
    return library


def _matmul(a: Tensor, b: Tensor) -> Tensor:
    return torch.from_numpy(np.matmul(a.detach().numpy(), b.detach().numpy()))


def _addmm(
    bias: Tensor, a: Tensor, b: Tensor, *, beta: int | float = 1, alpha: int | float = 1
) -> Tensor:
    product = _matmul(a, b)
    if alpha != 1:
        product *= alpha
    return product.add_(bias, alpha=beta) if beta else product


def _sqrt(x: Tensor) -> Tensor:
    if not x.is_floating_point():
        x = x.to(torch.get_default_dtype())
    root = torch.empty_like(x)
    return _write_sqrt(x, root)


def _sqrt_in_place(x: Tensor) -> Tensor:
    return _write_sqrt(x, x)


def _write_sqrt(x: Tensor, root: Tensor) -> Tensor:
    with np.errstate(invalid="ignore"):  # of a negative number: NaN, as torch has it
        np.sqrt(x.detach().numpy(), out=root.detach().numpy())
    return root
