"""Run the method, from the start or from a checkpoint."""

from functools import partial
from importlib import import_module

import numpy as np
from jaxtyping import Float

from industnerf.errors import BadArtifact, ReconstructionFailed
from industnerf.methods.industnerf.pipeline import PosedImages, ReconstructionResult
from industnerf.reconstruct import checkpoint
from industnerf.reconstruct.callbacks import CliCallback
from industnerf.reconstruct.cli import Options
from industnerf.reconstruct.display import Display
from industnerf.reconstruct.load_images import ImageSet
from industnerf.reconstruct.run_fingerprint import method_module, run_fingerprint
from industnerf.reconstruct.settings import ResolvedConfig
from industnerf.reconstruct.signal_handling import GracefulInterrupt
from industnerf.seeds import seed_for


def run_reconstruction(
    options: Options,
    image_set: ImageSet,
    center: Float[np.ndarray, "3"],
    radius: float,
    config: ResolvedConfig,
    display: Display,
) -> ReconstructionResult:
    """What the method makes of `album`; raises ReconstructionFailed if that is nothing.

    Raises BadArtifact if there is a checkpoint of another run.
    """
    fingerprint = run_fingerprint(image_set, center, radius, config)
    state = _load_checkpoint(options, fingerprint, display)
    posed_images = PosedImages(
        image_set.rgb, image_set.cameras, image_set.background, center, radius
    )
    seed = seed_for(config.seed, "reconstruct", config.method)
    with GracefulInterrupt() as interrupt:
        callback = CliCallback(
            display,
            interrupt,
            partial(checkpoint.save, options.checkpoint, fingerprint=fingerprint),
            options.checkpoint_every,
            options.preview,
            options.preview_every,
        )
        run = import_module(method_module(config.method)).run
        result = run(posed_images, config.settings, seed, callback, state)
    return _check_result(result)


def _load_checkpoint(
    options: Options, fingerprint: checkpoint.Fingerprint, display: Display
) -> dict | None:
    path = options.checkpoint
    if not path.exists():
        return None
    if not checkpoint.is_checkpoint(path):
        raise BadArtifact(f"{path} is there and is no checkpoint; name another by --checkpoint")
    if options.no_resume:
        path.unlink()
        return None
    state = checkpoint.load(path, fingerprint)
    display.log(f"going on from {path}")
    return state


def _check_result(result: ReconstructionResult) -> ReconstructionResult:
    if not len(result.points):
        raise ReconstructionFailed(
            "the method found no surface: is the part inside the region of interest, and do the "
            "cameras belong to these photographs?"
        )
    num_invalid = int((~np.isfinite(result.points).all(axis=1)).sum())
    if num_invalid:
        raise ReconstructionFailed(f"not finite: {num_invalid} of {len(result.points)} points")
    return result
