"""Whether the device that INDUSTNERF_DEVICE names (cpu, cuda, cuda:1) is where the work is done."""

import re

from industnerf import environment
from industnerf.errors import BadParams

NAME = re.compile(r"cpu|cuda(:(?P<number>\d+))?")


def check_device(*, here: bool) -> None:
    """Raises BadParams if INDUSTNERF_DEVICE names no device, or none of this machine if `here`.

    Asked before any work begins: else every part would fail for it, and that be its result.
    """
    name = environment.get_str("INDUSTNERF_DEVICE") or "cpu"
    match = NAME.fullmatch(name)
    if match is None:
        raise BadParams(f"INDUSTNERF_DEVICE is {name!r}, must be cpu, cuda or cuda:N")
    if name == "cpu" or not here:
        return
    import torch  # late: most stages have no tensors

    device_count = torch.cuda.device_count()
    if int(match["number"] or 0) >= device_count:
        raise BadParams(
            f"INDUSTNERF_DEVICE is {name!r}, but torch finds {device_count} such devices here"
        )
