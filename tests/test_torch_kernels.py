"""Matrix products and roots of torch on the CPU, against float64."""

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest
import torch
from torch import Tensor

from industnerf import processor, torch_kernels
from industnerf.torch_kernels import BLOCK, use_reproducible_kernels

# Rounding of a sum of k products of normal numbers: some k^(1/2) units in the last place of its
# largest partial sum, below 1e-6 k in float32.
TOLERANCE = 1e-6


@pytest.fixture(autouse=True)
def kernels() -> None:
    use_reproducible_kernels()


def normal(*shape: int) -> Tensor:
    return torch.randn(*shape, generator=torch.Generator().manual_seed(sum(shape)))


@pytest.mark.parametrize("shape", [((5, 7), (7, 3)), ((4, 5, 7), (4, 7, 3)), ((0, 7), (7, 3))])
def test_products_agree_with_float64(shape: tuple[tuple[int, ...], tuple[int, ...]]) -> None:
    a, b = normal(*shape[0]), normal(*shape[1])
    expected = (a.double()[..., :, :, None] * b.double()[..., None, :, :]).sum(-2)
    torch.testing.assert_close((a @ b).double(), expected, rtol=0, atol=7 * TOLERANCE)


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize(
    ("rows", "terms", "columns"), [(2 * BLOCK + 5, 7, 3), (3, 2 * BLOCK + 5, 4), (3, 7, 2 * BLOCK)]
)
def test_blocks_add_up_and_the_number_of_threads_changes_no_byte(
    rows: int, terms: int, columns: int, threads: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    a, b = normal(rows, terms), normal(terms, columns)
    with ThreadPoolExecutor(threads) as pool, monkeypatch.context() as patch:
        patch.setattr(torch_kernels, "_pool", lambda: pool)
        product = a @ b
    expected = a.double().numpy() @ b.double().numpy()
    torch.testing.assert_close(
        product.double().numpy(), expected, rtol=0, atol=terms**0.5 * 10 * TOLERANCE
    )
    assert torch.equal(product, a @ b)


def test_where_parts_run_side_by_side_each_has_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    assert torch_kernels.num_threads() == 1
    monkeypatch.delenv("OMP_NUM_THREADS")
    assert torch_kernels.num_threads() == len(os.sched_getaffinity(0))


@pytest.mark.parametrize("transposed", [False, True])
def test_a_transposed_operand_is_not_read_in_the_wrong_order(transposed: bool) -> None:
    a, b = normal(6, 6), normal(6, 6)
    product = a @ b.T if transposed else a @ b
    columns = b if transposed else b.T
    expected = torch.stack([(a * column).sum(1) for column in columns], dim=1)
    torch.testing.assert_close(product, expected, rtol=0, atol=6 * TOLERANCE)


@pytest.mark.parametrize(("beta", "alpha"), [(1.0, 1.0), (0.0, 1.0), (2.0, 1.0), (1.0, 0.5)])
def test_the_sum_with_a_bias(beta: float, alpha: float) -> None:
    bias, a, b = normal(3), normal(5, 7), normal(7, 3)
    expected = beta * bias + alpha * (a @ b)
    result = torch.addmm(bias, a, b, beta=beta, alpha=alpha)
    torch.testing.assert_close(result, expected, rtol=0, atol=7 * TOLERANCE)
    batch = torch.baddbmm(bias.expand(2, 1, 3), a.expand(2, 5, 7), b.expand(2, 7, 3), beta=beta)
    torch.testing.assert_close(batch[1], beta * bias + a @ b, rtol=0, atol=7 * TOLERANCE)


def test_a_bias_that_is_not_a_number_does_not_count_with_beta_0() -> None:
    bias = torch.full((3,), torch.nan)
    assert torch.addmm(bias, normal(5, 7), normal(7, 3), beta=0).isfinite().all()


def test_gradients_of_a_linear_layer() -> None:
    layer = torch.nn.Linear(7, 3).double()
    x = normal(5, 7).double().requires_grad_()
    assert torch.autograd.gradcheck(layer, (x,))


def test_roots_are_correctly_rounded() -> None:
    x = normal(1000).abs()
    expected = x.double().sqrt().float()  # float64's root, rounded once more, is the nearest
    assert torch.equal(x.sqrt(), expected)
    assert torch.equal(x.clone().sqrt_(), expected)
    assert torch.equal(x[::2].sqrt(), expected[::2])
    assert torch.equal(x[0].sqrt(), expected[0])
    assert torch.equal(torch.tensor([4, 9]).sqrt(), torch.tensor([2.0, 3.0]))
    assert (-x).sqrt().isnan().all()


def test_products_and_roots_are_the_kernels_here_and_not_torchs_own() -> None:
    for name in ("mm", "bmm", "addmm", "baddbmm", "sqrt", "sqrt_"):
        table = torch._C._dispatch_dump_table(f"aten::{name}")
        (line,) = [line for line in table.splitlines() if line.startswith("CPU:")]
        assert "torch_kernels" in line, line


@pytest.mark.parametrize("dtype", [torch.bfloat16, torch.float16, torch.complex64])
def test_a_dtype_without_a_kernel_is_refused_and_not_computed_otherwise(dtype: torch.dtype) -> None:
    with pytest.raises(NotImplementedError, match="use float32 or float64"):
        torch.ones(2, 2, dtype=dtype) @ torch.ones(2, 2, dtype=dtype)
    with pytest.raises(NotImplementedError, match="use float32 or float64"):
        torch.ones(2, dtype=dtype).sqrt()


def test_operands_of_two_dtypes_are_refused_as_by_torch() -> None:
    with pytest.raises(RuntimeError, match="same dtype"):
        torch.mm(normal(2, 3), normal(3, 2).double())


def test_whoever_loads_numpy_first_is_told() -> None:
    code = (
        "import numpy; from industnerf.torch_kernels import use_reproducible_kernels as use; use()"
    )
    environment = {k: v for k, v in os.environ.items() if k not in processor.PINNED}
    run = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    assert "numpy came before industnerf" in run.stderr
