"""Where tensors live: INDUSTNERF_DEVICE (cpu, cuda, cuda:1), or a GPU where there is one."""

import re
from typing import TYPE_CHECKING

from industnerf import environment
from industnerf.errors import BadParams

if TYPE_CHECKING:
    import torch

NAME = re.compile(r"cpu|cuda(:(?P<number>\d+))?")


def device() -> "torch.device":
    """The device of whatever is trained."""
    import torch  # late: stages without tensors check the variable too

    name = environment.text("INDUSTNERF_DEVICE")
    return torch.device(name or ("cuda" if torch.cuda.is_available() else "cpu"))


def check_device(*, here: bool) -> None:
    """Raises BadParams if INDUSTNERF_DEVICE names no device, or none of this machine if `here`.

    A stage asks before it begins: else every part would fail for it, and that be its result.
    """
    name = environment.text("INDUSTNERF_DEVICE") or "cpu"
    match = NAME.fullmatch(name)
    if match is None:
        raise BadParams(f"INDUSTNERF_DEVICE is {name!r}, must be cpu, cuda or cuda:N")
    if name == "cpu" or not here:
        return
    import torch

    found = torch.cuda.device_count()
    if int(match["number"] or 0) >= found:
        raise BadParams(f"INDUSTNERF_DEVICE is {name!r}, but torch finds {found} such devices here")
