"""Whether there is a GPU, and who sees it.  Without one everything runs too: nothing is wrong."""

import shutil
import subprocess
from pathlib import Path

from industnerf.doctor.findings import Finding
from industnerf.doctor.places import Places

QUERY = ("nvidia-smi", "--query-gpu=name,driver_version,memory.total", "--format=csv,noheader")


def find(places: Places) -> list[Finding]:
    """What the driver, torch and warp each see; for information only."""
    device = Path("/dev/nvidia0")
    return [Finding(device, text) for text in (_driver(), _torch(), _warp())]


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

    warp.config.quiet = True
    warp.init()
    devices = warp.get_cuda_devices()
    seen = ", ".join(device.name for device in devices) or "no GPU: kernels run on the CPU"
    return f"warp {warp.__version__} sees {seen}"
