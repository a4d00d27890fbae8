"""Where tensors live: INDUSTNERF_DEVICE, or a GPU where there is one."""

import torch

from industnerf import environment


def device() -> torch.device:
    """The device of whatever is trained."""
    name = environment.get_str("INDUSTNERF_DEVICE")
    return torch.device(name or ("cuda" if torch.cuda.is_available() else "cpu"))
