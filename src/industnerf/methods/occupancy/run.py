"""Train the network, and reconstruct a part with it, view by view."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from industnerf.artifacts.state import ModelState
from industnerf.device import device
from industnerf.geometry.isosurface import isosurface_points
from industnerf.learning.augment import images_to_tensor
from industnerf.learning.training import model_state, train, train_val_split
from industnerf.learning.views import axis_rotations, evenly_spaced_indices, resize_images
from industnerf.learning.weights import load_arrays, torch_seed
from industnerf.methods.base import Example, MethodInputs, Reconstruction
from industnerf.methods.multi_view_predictions import predictions_to_reconstruction
from industnerf.methods.occupancy.dataset import OccupancyDataset
from industnerf.methods.occupancy.mise import mise
from industnerf.methods.occupancy.network import OccupancyNet
from industnerf.schema import OccupancySettings
from industnerf.seeds import generator
from industnerf.torch_kernels import use_reproducible_kernels

POINT_BATCH = 16384  # points that the network is evaluated on at once


def fit(
    examples: Sequence[Example], settings: OccupancySettings, seed: int, scratch: Path
) -> ModelState:
    """Train on the parts that are not for validation; same seed, same bytes on a CPU."""
    use_reproducible_kernels()  # folds are what runs side by side
    dataset = OccupancyDataset.of(examples, settings, generator(seed, "lessons"))
    with torch_seed(seed):
        net = OccupancyNet(settings).to(device())
    split = train_val_split(examples, settings.training.val_fraction)
    checkpoint = scratch / "occupancy.pt"
    result = train(net, partial(dataset.loss, net), split, settings.training, seed, checkpoint)
    return model_state(net, result, len(split[0]), settings.size)


@torch.inference_mode()
def reconstruct(
    inputs: MethodInputs, settings: OccupancySettings, state: ModelState, seed: int
) -> Reconstruction:
    """One prediction a view, each of area-uniform points.

    Raises ReconstructionFailed if all are empty.
    """
    use_reproducible_kernels()  # parts are what runs side by side
    net = OccupancyNet(settings).to(device()).eval()
    load_arrays(net, state.arrays)
    view_indices = evenly_spaced_indices(len(inputs.rgb), settings.eval_views)
    codes = net.encode(
        images_to_tensor(resize_images(inputs.rgb[view_indices], settings.image_px), device())
    )
    rotations = axis_rotations(inputs.cameras[view_indices], settings.output_axes)
    rng = np.random.default_rng(seed)
    clouds = [surface(net, *view, settings, rng) for view in zip(codes, rotations, strict=True)]
    return predictions_to_reconstruction(clouds, inputs.part_frame, state)


def surface(
    net: OccupancyNet,
    code: Float[Tensor, "code"],
    rotation: Float[np.ndarray, "3 3"],
    settings: OccupancySettings,
    rng: np.random.Generator,
) -> Float[np.ndarray, "_ 3"]:
    """Points where the probability of being inside, given `code`, is the threshold; maybe none.

    The network is evaluated on points @ `rotation`.
    """
    level = float(np.log(settings.threshold / (1 - settings.threshold)))
    lo = np.full(3, -(1 + settings.padding) / 2)
    spacing = (1 + settings.padding) / (settings.resolution_0 * 2**settings.upsampling_steps)

    def field(corners: Int[np.ndarray, "p 3"]) -> Float[np.ndarray, "p"]:
        points = torch.from_numpy((lo + spacing * corners) @ rotation).to(code).split(POINT_BATCH)
        return torch.cat([net.decoder(some[None], code[None])[0] for some in points]).cpu().numpy()

    values, _ = mise(field, level, settings.resolution_0, settings.upsampling_steps)
    return isosurface_points(values, level, lo, spacing, settings.points, rng)
