"""Libraries are held to AVX2 before they choose their kernels."""

import os
import platform
import subprocess
import sys
from pathlib import Path

import pytest

from industnerf import processor


def run_python(code: str, **environment: str) -> str:
    """What a new process prints that runs `code`."""
    free = {name: value for name, value in os.environ.items() if name not in processor.PINNED}
    return subprocess.run(
        [sys.executable, "-c", code],
        env=free | environment,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.strip()


def test_the_environment_is_there_before_numpy_loads() -> None:
    code = (
        "import industnerf, numpy._core._multiarray_umath as m\n"
        "print(any(m.__cpu_features__[n] for n in ('X86_V4', 'AVX512_ICL', 'AVX512_SPR')))"
    )
    assert run_python(code) == "False"


def test_torch_computes_with_avx2() -> None:
    code = "import industnerf, torch; print(torch.backends.cpu.get_cpu_capability())"
    assert run_python(code) == "AVX2"


def test_another_value_of_the_user_does_not_win() -> None:
    code = "import industnerf, os; print(os.environ['MKL_CBWR'])"
    assert run_python(code, MKL_CBWR="AVX512") == "COMPATIBLE"


def test_a_library_that_was_there_before_is_told() -> None:
    code = (
        "import numpy, industnerf; from industnerf import processor;"
        "print(processor.unpinned_libraries(), processor.isa())"
    )
    late, isa = run_python(code).rsplit(maxsplit=1)
    assert late == "['numpy']"
    assert isa.endswith("-native")


def test_a_process_that_inherits_the_environment_is_pinned() -> None:
    code = "import numpy, industnerf; print(industnerf.processor.unpinned_libraries())"
    assert run_python(code, **processor.PINNED) == "[]"


@pytest.mark.parametrize("name", ["torch", "numpy", "warp"])
def test_the_suite_itself_loads_none_of_the_large_libraries(name: str) -> None:
    assert run_python(f"import industnerf, sys; print('{name}' in sys.modules)") == "False"


def test_the_model_is_the_kernels_word_or_else_the_architecture(tmp_path: Path) -> None:
    file = tmp_path / "cpuinfo"
    assert processor.model(file) == platform.machine()
    file.write_text("flags : fpu\nmodel name\t: Some CPU @ 2: 3 GHz\nmodel name\t: Other\n")
    assert processor.model(file) == "Some CPU @ 2: 3 GHz"
