"""Run the method, from the start or from a checkpoint."""

from functools import partial

import numpy as np
from jaxtyping import Float

from industnerf.errors import BadArtifact, ReconstructionFailed
from industnerf.methods.industnerf.run import Outcome, Posed, run
from industnerf.reconstruct import checkpoint
from industnerf.reconstruct.display import Display
from industnerf.reconstruct.gather import Album
from industnerf.reconstruct.interrupt import Interrupt
from industnerf.reconstruct.options import Options
from industnerf.reconstruct.origin import origin_of
from industnerf.reconstruct.settings import Chosen
from industnerf.reconstruct.watching import Watching
from industnerf.seeds import seed_for


def work(
    options: Options,
    album: Album,
    centre: Float[np.ndarray, "3"],
    radius: float,
    chosen: Chosen,
    display: Display,
) -> Outcome:
    """What the method makes of `album`; raises ReconstructionFailed if that is nothing.

    Raises BadArtifact if there is a checkpoint of another run.
    """
    origin = origin_of(album, centre, radius, chosen)
    state = _resume(options, origin, display)
    posed = Posed(album.rgb, album.cameras, album.background, centre, radius)
    seed = seed_for(chosen.seed, "reconstruct", chosen.method)
    with Interrupt() as stop:
        watching = Watching(
            display,
            stop,
            partial(checkpoint.save, options.checkpoint, origin=origin),
            options.checkpoint_every,
            options.preview,
            options.preview_every,
        )
        outcome = run(posed, chosen.settings, seed, watching, state)
    return _checked(outcome)


def _resume(options: Options, origin: checkpoint.Origin, display: Display) -> dict | None:
    path = options.checkpoint
    if not path.exists():
        return None
    if not checkpoint.is_checkpoint(path):
        raise BadArtifact(f"{path} is there and is no checkpoint; name another by --checkpoint")
    if options.fresh:
        path.unlink()
        return None
    state = checkpoint.load(path, origin)
    display.say(f"going on from {path}")
    return state


def _checked(outcome: Outcome) -> Outcome:
    if not len(outcome.points):
        raise ReconstructionFailed(
            "the method found no surface: is the part inside the region of interest, and do the "
            "cameras belong to these photographs?"
        )
    bad = int((~np.isfinite(outcome.points).all(axis=1)).sum())
    if bad:
        raise ReconstructionFailed(f"not finite: {bad} of {len(outcome.points)} points")
    return outcome
