"""Kernels of torch on the CPU that do not depend on who made the processor.

torch leaves matrix products and square roots to Intel's MKL.  Its products add in another order on
each make of processor, and on all alike only in a mode of half the speed; numpy's OpenBLAS takes a
kernel by name (`industnerf.processor`), and is as fast.  Its roots begin with the processor's
approximation of 1/sqrt, which is not the same for all makes; those of the processor are exact.

Products are made in blocks of fixed size, so that the number of threads does not change a byte.
"""

import os
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache

import numpy as np
import torch
from torch import Tensor

from industnerf import processor

BLOCK = 4096  # rows, or terms of a sum, that one thread takes at a time
UNSUPPORTED = (torch.float16, torch.bfloat16, torch.complex64, torch.complex128)


def use_reproducible_kernels() -> None:
    """From here on torch computes the same bytes on every x86-64 CPU, with however many cores.

    Sums of torch depend on its threads, so it has one; matrix products have `num_threads`.  Warns
    where numpy or torch was loaded before `industnerf`: then they are this processor's.
    """
    if late := processor.unpinned_libraries():
        warnings.warn(
            f"{' and '.join(late)} came before industnerf and chose kernels by this processor: "
            "another gives other bytes; import industnerf first",
            RuntimeWarning,
            stacklevel=2,
        )
    torch.set_num_threads(1)
    register_kernels()


def num_threads() -> int:
    """OMP_NUM_THREADS, which is 1 where parts run side by side; else the cores of this process."""
    return int(os.environ.get("OMP_NUM_THREADS") or len(os.sched_getaffinity(0)))


@cache
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(num_threads())


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
    _require_real(a, b)
    if a.dtype != b.dtype:
        raise RuntimeError(f"expected operands of the same dtype, got {a.dtype} and {b.dtype}")
    x, y = a.detach().numpy(), b.detach().numpy()
    rows, terms = x.shape[-2:]
    if x.ndim == 3 or max(rows, terms) <= BLOCK:
        return torch.from_numpy(_multiply(x, y))
    if rows > BLOCK:
        product = np.empty((rows, y.shape[1]), np.result_type(x, y))
        _map_blocks(lambda block: _multiply(x[block], y, out=product[block]), rows)
    else:
        product, *others = _map_blocks(lambda block: _multiply(x[:, block], y[block]), terms)
        for other in others:
            product += other
    return torch.from_numpy(product)


@np.errstate(over="ignore", invalid="ignore")  # silent as torch is: the loss will tell
def _multiply(x: np.ndarray, y: np.ndarray, out: np.ndarray | None = None) -> np.ndarray:
    return np.matmul(x, y, out=out)


def _require_real(*tensors: Tensor) -> None:
    for tensor in tensors:
        if tensor.dtype in UNSUPPORTED:
            raise NotImplementedError(
                f"industnerf.torch_kernels has no kernel for {tensor.dtype}; use float32 or float64"
            )


def _map_blocks(multiply: Callable[[slice], np.ndarray], size: int) -> list[np.ndarray]:
    blocks = [slice(start, start + BLOCK) for start in range(0, size, BLOCK)]
    return list(_pool().map(multiply, blocks))


def _addmm(
    bias: Tensor, a: Tensor, b: Tensor, *, beta: int | float = 1, alpha: int | float = 1
) -> Tensor:
    product = _matmul(a, b)
    if alpha != 1:
        product *= alpha
    return product.add_(bias, alpha=beta) if beta else product


def _sqrt(x: Tensor) -> Tensor:
    _require_real(x)
    if not x.is_floating_point():
        x = x.to(torch.get_default_dtype())
    root = torch.empty_like(x)
    return _write_sqrt(x, root)


def _sqrt_in_place(x: Tensor) -> Tensor:
    _require_real(x)
    return _write_sqrt(x, x)


def _write_sqrt(x: Tensor, root: Tensor) -> Tensor:
    with np.errstate(invalid="ignore"):  # of a negative number: NaN, as torch has it
        np.sqrt(x.detach().numpy(), out=root.detach().numpy())
    return root
