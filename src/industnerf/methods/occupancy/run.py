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
from industnerf.geometry.isosurface import isosurface_points, volume_matched_level
from industnerf.learning.fit import fit_network
from industnerf.learning.targets import PADDING
from industnerf.learning.training_shape import Prior, TrainingShape
from industnerf.learning.weights import load_arrays, torch_seed
from industnerf.methods.base import MethodInputs, Reconstruction
from industnerf.methods.first_views import first_views
from industnerf.methods.multi_view_predictions import predictions_to_reconstruction
from industnerf.methods.occupancy.dataset import OccupancyDataset, decoder_points
from industnerf.methods.occupancy.mise import mise
from industnerf.methods.occupancy.network import OccupancyNet
from industnerf.schema import OccupancySettings
from industnerf.seeds import generator
from industnerf.torch_kernels import use_reproducible_kernels

POINT_BATCH = 16384  # points that the network is evaluated on at once


def fit(
    examples: Sequence[TrainingShape],
    settings: OccupancySettings,
    seed: int,
    scratch: Path,
    prior: Prior,
) -> ModelState:
    """Train on the parts that are not for validation; same seed, same bytes on a CPU."""
    use_reproducible_kernels()  # folds are what runs side by side
    shapes = [*examples, *prior.solids]
    dataset = OccupancyDataset.of(shapes, settings, generator(seed, "lessons"))
    with torch_seed(seed):
        net = OccupancyNet(settings).to(device())
    return fit_network(
        net,
        partial(dataset.loss, net),
        examples,
        prior,
        settings.training,
        seed,
        scratch / "occupancy.pt",
        settings.size,
    )


@torch.inference_mode()
def reconstruct(
    inputs: MethodInputs, settings: OccupancySettings, state: ModelState, seed: int
) -> Reconstruction:
    """One prediction a view, each of area-uniform points."""
    use_reproducible_kernels()  # parts are what runs side by side
    net = OccupancyNet(settings).to(device()).eval()
    load_arrays(net, state.arrays)
    contrasts, frames = first_views(inputs, settings.eval_views, settings.image_px, device())
    codes = net.encode(contrasts)
    rng = np.random.default_rng(seed)
    clouds = [surface(net, *view, settings, rng) for view in zip(codes, frames, strict=True)]
    return predictions_to_reconstruction(clouds, inputs.part_frame, state)


def surface(
    net: OccupancyNet,
    code: Float[Tensor, "code"],
    frame: Float[np.ndarray, "3 3"],
    settings: OccupancySettings,
    rng: np.random.Generator,
) -> Float[np.ndarray, "_ 3"]:
    """Points of the volume-matched surface of what the network predicts, given `code`.

    `frame` is that of the picture.
    """
    lo = np.full(3, -(1 + PADDING) / 2)
    spacing = (1 + PADDING) / (settings.resolution_0 * 2**settings.upsampling_steps)

    def probability(corners: Int[np.ndarray, "p 3"]) -> Float[np.ndarray, "p"]:
        points = decoder_points((lo + spacing * corners)[None], frame[None], settings.query_axes)
        batches = torch.from_numpy(points).to(code).split(POINT_BATCH, dim=1)
        logits = torch.cat([net.decoder(some, code[None])[0] for some in batches])
        return torch.sigmoid(logits).cpu().numpy()

    resolution, steps = settings.resolution_0, settings.upsampling_steps
    values, level, _ = mise(probability, volume_matched_level, resolution, steps)
    return isosurface_points(values, level, lo, spacing, settings.points, rng)
