"""What a run is made from, as digests: a checkpoint belongs to the run that has the same ones."""

import hashlib
import json
from dataclasses import asdict

import numpy as np
from jaxtyping import Float

from industnerf.code_hash import code_digest
from industnerf.device import device
from industnerf.reconstruct.load_images import ImageSet
from industnerf.reconstruct.settings import ResolvedConfig


def method_module(method: str) -> str:
    """The module of a method whose `run` reconstructs from posed images."""
    return f"industnerf.methods.{method}.pipeline"


def run_fingerprint(
    image_set: ImageSet, center: Float[np.ndarray, "3"], radius: float, config: ResolvedConfig
) -> dict[str, str]:
    """A digest of each thing that a run depends on, by a name to say to a user."""
    cameras = image_set.cameras
    background = np.zeros(0) if image_set.background is None else image_set.background
    return {
        "images": _digest(image_set.rgb),
        "background": _digest(background),
        "cameras": _digest(cameras.K, cameras.c2w),
        "region of interest": _digest(center, np.array(radius)),
        "method": config.method,
        "settings": hashlib.sha256(
            json.dumps(asdict(config.settings), sort_keys=True).encode()
        ).hexdigest(),
        "seed": str(config.seed),
        "code of the method": code_digest(method_module(config.method)),
        "device": device().type,  # on another, roundings sort other points out
    }


def _digest(*arrays: np.ndarray) -> str:
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(f"{array.dtype} {array.shape}\n".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()
