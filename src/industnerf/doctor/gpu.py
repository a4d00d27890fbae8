"""Whether there is a GPU, and who sees it.

Without one everything runs too, and nothing is wrong, unless INDUSTNERF_DEVICE asks for it.
"""

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

from industnerf import environment
from industnerf.doctor.findings import Finding
from industnerf.doctor.places import Places
from industnerf.errors import BadParams
from industnerf.runner.device import check_device

# Empty is as good as not set, and wins over .industnerf.env too, which `unset` would not.
NONE = "export INDUSTNERF_DEVICE="
QUERY = ("nvidia-smi", "--query-gpu=name,driver_version,memory.total", "--format=csv,noheader")


def find(places: Places) -> list[Finding]:
    """What the driver, torch and warp each see, for information; a device asked for in vain."""
    device = Path("/dev/nvidia0")
    seen = [Finding(device, text) for text in (_driver(), _said(_torch), _said(_warp))]
    return [*seen, *(Finding(device, text, NONE) for text in _in_vain())]


def _said(ask: Callable[[], str]) -> str:
    """What `ask` says, or why its library cannot be asked."""
    try:
        return ask()
    except ImportError as error:
        return f"{error}: `python -m industnerf.doctor environment` says what to install"


def _in_vain() -> list[str]:
    """What refuses the device that is asked for; with submitit other machines have to have it."""
    try:
        check_device(here=environment.text("INDUSTNERF_RUNNER") != "submitit")
    except (BadParams, ImportError) as error:
        return [f"{error}: no stage begins; name one that is there, or none"]
    return []


def _driver() -> str:
    if not shutil.which(QUERY[0]):
        return "no NVIDIA driver (no nvidia-smi)"
    done = subprocess.run(QUERY, capture_output=True, text=True, check=False)
    answer = " ".join((done.stdout if done.returncode == 0 else done.stderr or done.stdout).split())
    return f"the driver sees {answer}" if done.returncode == 0 else f"the driver fails: {answer}"


def _torch() -> str:
    import torch

    built = torch.version.cuda
    if built is None:
        return f"torch {torch.__version__} is built without CUDA: methods run on the CPU"
    if not torch.cuda.is_available():
        return f"torch {torch.__version__} (CUDA {built}) sees no GPU: none, or an older driver"
    names = [torch.cuda.get_device_name(i) for i in range(torch.cuda.device_count())]
    return f"torch {torch.__version__} (CUDA {built}) sees {', '.join(names)}"


def _warp() -> str:
    import warp

    from industnerf.geometry import compiled

    compiled.start()
    devices = warp.get_cuda_devices()
    seen = ", ".join(device.name for device in devices) or "no GPU: kernels run on the CPU"
    return f"warp {warp.__version__} sees {seen}"
