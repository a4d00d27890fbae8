"""The same bytes on every x86-64 processor with AVX2: what numeric libraries are told.

Libraries pick their kernels by what the processor can do and by who made it, and kernels differ in
the order of their sums.  Over a training such roundings grow: AtlasNet ends a third of its error
away.  So all are held to AVX2 (x86-64-v3), which every machine of the last ten years has.  They
read their environment as they load: `pin` comes before numpy.  Where matrix products of torch run
is said in `industnerf.torch_kernels`, Warp's flags in `industnerf.geometry.warp_runtime`, and
Embree's in `industnerf.geometry.embree_tree`.
"""

import os
import platform
import sys
from pathlib import Path

ISA = "x86-64-v3"
PINNED = {
    "ATEN_CPU_CAPABILITY": "avx2",  # torch's own kernels
    "ONEDNN_MAX_CPU_ISA": "AVX2",  # convolutions of torch
    "MKL_CBWR": "COMPATIBLE",  # the only mode of MKL that does not ask who made the processor
    "OPENBLAS_CORETYPE": "Haswell",  # matrix products of numpy and scipy
    "OPENBLAS_NUM_THREADS": "1",  # more divide sums by their number; see `torch_kernels`
    "NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL AVX512_SPR",  # functions and sorts of numpy
}
_late_libraries: list[str] = []


def pin() -> None:
    """Hold this process, and those that it starts, to AVX2; libraries loaded before are not."""
    global _late_libraries
    if any(os.environ.get(name) != value for name, value in PINNED.items()):
        _late_libraries = [name for name in ("numpy", "torch") if name in sys.modules]
        os.environ.update(PINNED)


def unpinned_libraries() -> list[str]:
    """Libraries that were imported before `industnerf`, and chose their kernels themselves."""
    return list(_late_libraries)


def model(path: Path = Path("/proc/cpuinfo")) -> str:
    """The processor's model, such as "AMD EPYC 9B45", or the architecture where it is not told."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.machine())


def isa() -> str:
    """What results are computed with: `ISA`, or on other architectures and unpinned their own."""
    is_x86 = platform.machine() in ("x86_64", "AMD64")
    return ISA if is_x86 and not _late_libraries else f"{platform.machine()}-native"
