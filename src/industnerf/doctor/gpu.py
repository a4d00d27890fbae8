"""Whether there is a GPU, and who sees it.

Without one everything runs too, and nothing is wrong, unless INDUSTNERF_DEVICE asks for it.
"""

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

from industnerf import environment
from industnerf.doctor.findings import Finding
from industnerf.doctor.project_paths import ProjectPaths
from industnerf.errors import BadParams
from industnerf.runner.device import check_device

# Empty is as good as not set, and wins over .industnerf.env too, which `unset` would not.
UNSET_DEVICE = "export INDUSTNERF_DEVICE="
QUERY = ("nvidia-smi", "--query-gpu=name,driver_version,memory.total", "--format=csv,noheader")


def check(paths: ProjectPaths) -> list[Finding]:
    """What the driver, torch and warp each see, for information; a device asked for in vain."""
    device = Path("/dev/nvidia0")
    findings = [
        Finding(device, text)
        for text in (_describe_driver(), _describe(_describe_torch), _describe(_describe_warp))
    ]
    return [*findings, *(Finding(device, text, UNSET_DEVICE) for text in _device_errors())]


def _describe(query: Callable[[], str]) -> str:
    """What `ask` says, or why its library cannot be asked."""
    try:
        return query()
    except ImportError as error:
        return f"{error}: `python -m industnerf.doctor environment` says what to install"


def _device_errors() -> list[str]:
    """What refuses the device that is asked for; with submitit other machines have to have it."""
    try:
        check_device(here=environment.get_str("INDUSTNERF_RUNNER") != "submitit")
    except (BadParams, ImportError) as error:
        return [f"{error}: no stage begins; name one that is there, or none"]
    return []


def _describe_driver() -> str:
    if not shutil.which(QUERY[0]):
        return "no NVIDIA driver (no nvidia-smi)"
    process = subprocess.run(QUERY, capture_output=True, text=True, check=False)
    output = " ".join(
        (process.stdout if process.returncode == 0 else process.stderr or process.stdout).split()
    )
    return f"the driver sees {output}" if process.returncode == 0 else f"the driver fails: {output}"


def _describe_torch() -> str:
    import torch

    cuda_version = torch.version.cuda
    if cuda_version is None:
        return f"torch {torch.__version__} is built without CUDA: methods run on the CPU"
    if not torch.cuda.is_available():
        return (
            f"torch {torch.__version__} (CUDA {cuda_version}) sees no GPU: none, or an older driver"
        )
    names = [torch.cuda.get_device_name(i) for i in range(torch.cuda.device_count())]
    return f"torch {torch.__version__} (CUDA {cuda_version}) sees {', '.join(names)}"


def _describe_warp() -> str:
    import warp

    from industnerf.geometry import warp_runtime

    warp_runtime.init_warp()
    devices = warp.get_cuda_devices()
    device_names = ", ".join(device.name for device in devices) or "no GPU: kernels run on the CPU"
    return f"warp {warp.__version__} sees {device_names}"
