"""From pictures of a part to points of its surface, by a net that is trained."""

import numpy as np
import torch
from jaxtyping import Float32

from industnerf.artifacts.state import State
from industnerf.device import device
from industnerf.geometry.isosurface import isosurface_points
from industnerf.geometry.nested import nested
from industnerf.learning.augment import as_tensor
from industnerf.learning.pictures import scaled
from industnerf.learning.weights import load_arrays
from industnerf.methods.answers import answered
from industnerf.methods.base import Given, Reconstruction
from industnerf.methods.r2n2.decoder import VOXELS
from industnerf.methods.r2n2.net import R2N2, new_net
from industnerf.schema import R2n2Settings


def predicted(given: Given, settings: R2n2Settings, state: State, seed: int) -> Reconstruction:
    """One answer of all views: area-uniform points of the surface at the threshold."""
    likely = likelihood(given, settings, rebuilt(settings, state))
    centre, rng = np.full(3, 0.5 / VOXELS - 0.5), np.random.default_rng(seed)
    points = isosurface_points(likely, settings.threshold, centre, 1 / VOXELS, settings.points, rng)
    return answered([points], given.frame, state)


def rebuilt(settings: R2n2Settings, state: State) -> R2N2:
    """The net with the weights of `state`."""
    torch.set_num_threads(1)  # parts are what runs side by side
    net = new_net(settings.image_px, settings.divisor, seed=0)
    load_arrays(net, state.arrays)
    return net.to(device()).eval()


def likelihood(given: Given, settings: R2n2Settings, net: R2N2) -> Float32[np.ndarray, "n n n"]:
    """How likely each voxel of the unit cube is full, after all of `views` views."""
    # farthest apart in space: every n-th camera of a spiral may look from the same side
    chosen = nested(given.cameras.eyes, min(settings.views, len(given.rgb)))
    pictures = as_tensor(scaled(given.rgb[chosen], settings.image_px), device())
    return net.full(pictures[None])[0].cpu().numpy()
