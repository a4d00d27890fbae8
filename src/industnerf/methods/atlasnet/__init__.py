"""AtlasNet: a surface as patches that a network deforms, from one photograph.

Groueix et al., "A Papier-Mache Approach to Learning 3D Surface Generation" (2018), as the authors'
second code has it.  It sees one view at a time, so that several views give several predictions.
What differs: parts fill the unit cube, not the unit ball; no mirror images; fewer parts by far;
patches start on a sphere, the decoder has no batch norm, the Chamfer distance is not squared, and
one training of all weights takes the place of three.  `network` and `chamfer` have the reasons.
"""

from collections.abc import Sequence
from pathlib import Path

from industnerf.artifacts.state import ModelState
from industnerf.methods.base import Example, Input, Method, MethodInputs, Reconstruction, Scope
from industnerf.schema import AtlasNetSettings


def fit(
    examples: Sequence[Example], settings: AtlasNetSettings, seed: int, scratch: Path
) -> ModelState:
    """Weights of the image encoder and the decoder, after training."""
    # late: torch is slow to import
    from industnerf.methods.atlasnet.run import train_on_examples

    return train_on_examples(examples, settings, seed, scratch)


def reconstruct(
    inputs: MethodInputs, settings: AtlasNetSettings, state: ModelState, seed: int
) -> Reconstruction:
    """A prediction from each of `settings.eval_views` views, evenly chosen."""
    from industnerf.learning.views import axis_rotations, evenly_spaced_indices, resize_images
    from industnerf.methods.atlasnet.run import predict_clouds
    from industnerf.methods.multi_view_predictions import predictions_to_reconstruction

    view_indices = evenly_spaced_indices(len(inputs.rgb), settings.eval_views)
    images = resize_images(inputs.rgb[view_indices], settings.image_px)
    rotations = axis_rotations(inputs.cameras[view_indices], settings.output_axes)
    return predictions_to_reconstruction(
        predict_clouds(images, rotations, settings, state, seed), inputs.part_frame, state
    )


METHODS = {
    "atlasnet": Method(
        "atlasnet",
        Scope.DATASET,
        frozenset({Input.RGB, Input.PART_FRAME, Input.OTHER_MESHES}),
        reconstruct,
        fit,
        is_stochastic=True,
    )
}
