"""What a run is made from, as digests: a checkpoint belongs to the run that has the same ones."""

import hashlib
import json
from dataclasses import asdict

import numpy as np
from jaxtyping import Float

from industnerf.code import code_digest
from industnerf.device import device
from industnerf.reconstruct.gather import Album
from industnerf.reconstruct.settings import Chosen

METHOD = "industnerf.methods.industnerf.run"


def origin_of(
    album: Album, centre: Float[np.ndarray, "3"], radius: float, chosen: Chosen
) -> dict[str, str]:
    """A digest of each thing that a run depends on, by a name to say to a user."""
    cameras = album.cameras
    background = np.zeros(0) if album.background is None else album.background
    return {
        "images": _digest(album.rgb),
        "background": _digest(background),
        "cameras": _digest(cameras.K, cameras.c2w),
        "region of interest": _digest(centre, np.array(radius)),
        "method": chosen.method,
        "settings": hashlib.sha256(
            json.dumps(asdict(chosen.settings), sort_keys=True).encode()
        ).hexdigest(),
        "seed": str(chosen.seed),
        "code of the method": code_digest(METHOD),
        "device": device().type,  # on another, roundings sort other points out
    }


def _digest(*arrays: np.ndarray) -> str:
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(f"{array.dtype} {array.shape}\n".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()
