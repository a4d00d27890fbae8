"""AtlasNet's training, and its prediction from photographs."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from industnerf.artifacts.state import ModelState
from industnerf.device import device
from industnerf.geometry.sampling import sample_surface
from industnerf.learning.fit import fit_network
from industnerf.learning.training_shape import Prior, TrainingShape
from industnerf.learning.weights import load_arrays, torch_seed
from industnerf.methods.atlasnet.dataset import AtlasNetDataset
from industnerf.methods.atlasnet.network import AtlasNet, build_network
from industnerf.methods.base import MethodInputs, Reconstruction
from industnerf.methods.first_views import first_views
from industnerf.methods.multi_view_predictions import predictions_to_reconstruction
from industnerf.schema import AtlasNetSettings
from industnerf.seeds import generator
from industnerf.torch_kernels import use_reproducible_kernels


def fit(
    examples: Sequence[TrainingShape],
    settings: AtlasNetSettings,
    seed: int,
    scratch: Path,
    prior: Prior,
) -> ModelState:
    """The network trained on the parts that are not for validation."""
    use_reproducible_kernels()  # folds are what runs side by side
    dataset = AtlasNetDataset([*examples, *prior.solids], settings, generator(seed, "lessons"))
    with torch_seed(seed):
        net = build_network(settings).to(device())
    return fit_network(
        net,
        partial(dataset.loss, net),
        examples,
        prior,
        settings.training,
        seed,
        scratch / "atlasnet.pt",
        settings.size,
    )


@torch.no_grad()
def reconstruct(
    inputs: MethodInputs, settings: AtlasNetSettings, state: ModelState, seed: int
) -> Reconstruction:
    """One prediction a view, each of area-uniform points of all patches."""
    use_reproducible_kernels()  # parts are what runs side by side
    net = build_network(settings).to(device()).eval()
    load_arrays(net, state.arrays)
    contrasts, frames = first_views(inputs, settings.eval_views, settings.image_px, device())
    rng = np.random.default_rng(seed)
    clouds = [predict(net, *view, settings, rng) for view in zip(contrasts, frames, strict=True)]
    return predictions_to_reconstruction(clouds, inputs.part_frame, state)


def predict(
    net: AtlasNet,
    contrast: Float[Tensor, "3 px px"],
    frame: Float[np.ndarray, "3 3"],
    settings: AtlasNetSettings,
    rng: np.random.Generator,
) -> Float[np.ndarray, "points 3"]:
    """Points in the unit cube, predicted from one view, whose picture has the axes `frame`."""
    uv, faces = square_mesh(settings.grid_res)
    squares = torch.tensor(uv.T, dtype=torch.float32, device=device())
    points = net(
        contrast[None],
        torch.from_numpy(frame[None]).to(contrast),
        squares[None, :, None].expand(settings.patches, -1, -1, -1),
    )
    vertices = points.view(settings.patches, -1, 3).cpu().numpy().astype(np.float64)
    if settings.output_axes == "picture":
        vertices = vertices @ np.linalg.inv(frame)
    return sample_patches(vertices, faces, settings.points, rng)


def square_mesh(side: int) -> tuple[Float[np.ndarray, "n 2"], Int[np.ndarray, "m 3"]]:
    """`side`^2 regular points of the unit square, its border included, and its triangles."""
    u, v = np.meshgrid(*2 * [np.linspace(0, 1, side)], indexing="ij")
    corner = np.arange(side * side).reshape(side, side)
    a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    faces = np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)
    return np.stack([u.ravel(), v.ravel()], axis=1), faces


def sample_patches(
    vertices: Float[np.ndarray, "patches n 3"],
    faces: Int[np.ndarray, "m 3"],
    count: int,
    rng: np.random.Generator,
) -> Float[np.ndarray, "count 3"]:
    """`count` area-uniform points of all patches together, which share their triangles.

    Patches may overlap; where they do there are more points, for nothing tells which one to drop.
    """
    vertex_offsets = np.arange(len(vertices))[:, None, None] * vertices.shape[1]
    return sample_surface(
        vertices.reshape(-1, 3), (faces + vertex_offsets).reshape(-1, 3), count, rng
    )[0]
