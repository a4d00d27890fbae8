"""From images of a part to points of its surface, by a trained network."""

import numpy as np
from jaxtyping import Float32

from industnerf.artifacts.state import ModelState
from industnerf.device import device
from industnerf.geometry.isosurface import isosurface_points, volume_matched_level
from industnerf.learning.targets import VOXELS
from industnerf.learning.weights import load_arrays
from industnerf.methods.base import MethodInputs, Reconstruction
from industnerf.methods.first_views import first_views
from industnerf.methods.multi_view_predictions import predictions_to_reconstruction
from industnerf.methods.r2n2.network import R2N2, new_net
from industnerf.schema import R2n2Settings
from industnerf.torch_kernels import use_reproducible_kernels


def predict_part(
    inputs: MethodInputs, settings: R2n2Settings, state: ModelState, seed: int
) -> Reconstruction:
    """One prediction from all views: area-uniform points of the volume-matched surface."""
    probabilities = occupancy_probabilities(inputs, settings, load_net(settings, state))
    center, rng = np.full(3, 0.5 / VOXELS - 0.5), np.random.default_rng(seed)
    points = isosurface_points(
        probabilities,
        volume_matched_level(probabilities),
        center,
        1 / VOXELS,
        settings.points,
        rng,
    )
    return predictions_to_reconstruction([points], inputs.part_frame, state)


def load_net(settings: R2n2Settings, state: ModelState) -> R2N2:
    """The network with the weights of `state`."""
    use_reproducible_kernels()  # parts are what runs side by side
    net = new_net(settings.image_px, settings.channel_divisor, seed=0)
    load_arrays(net, state.arrays)
    return net.to(device()).eval()


def occupancy_probabilities(
    inputs: MethodInputs, settings: R2n2Settings, net: R2N2
) -> Float32[np.ndarray, "n n n"]:
    """The probability of each voxel of the unit cube to be full, from at most `max_views` views."""
    contrasts, _ = first_views(inputs, settings.max_views, settings.image_px, device())
    return net.occupancy_probability(contrasts[None])[0].cpu().numpy()
