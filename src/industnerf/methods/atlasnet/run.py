"""AtlasNet's training, and its prediction from photographs."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Int, UInt8
from torch import Tensor

from industnerf.artifacts.state import ModelState
from industnerf.device import device
from industnerf.geometry.sampling import sample_surface
from industnerf.learning.augment import images_to_tensor
from industnerf.learning.training import TrainResult, model_state, train, train_val_split
from industnerf.learning.weights import load_arrays, torch_seed
from industnerf.methods.atlasnet.dataset import AtlasNetDataset, ImageSource, image_loss
from industnerf.methods.atlasnet.network import AtlasNet, build_network
from industnerf.methods.base import Example
from industnerf.schema import AtlasNetSettings
from industnerf.seeds import generator
from industnerf.torch_kernels import use_reproducible_kernels


def train_on_examples(
    examples: Sequence[Example], settings: AtlasNetSettings, seed: int, scratch: Path
) -> ModelState:
    """The network trained on the parts that are not for validation."""
    use_reproducible_kernels()  # folds are what runs side by side
    dataset = AtlasNetDataset(examples, settings, generator(seed, "lessons"))
    split = train_val_split(examples, settings.training.val_fraction)
    net, result = train_network(dataset, split, settings, seed, scratch / "atlasnet.pt")
    return model_state(net, result, len(split[0]), settings.size)


def train_network(
    source: ImageSource,
    split: tuple[list[int], list[int]],
    settings: AtlasNetSettings,
    seed: int,
    checkpoint: Path,
    initial_weights: Mapping[str, np.ndarray] | None = None,
) -> tuple[AtlasNet, TrainResult]:
    """A network, from `initial_weights` or from random ones, trained on parts of `source`.

    `split` has the parts to train on and those to validate on.
    """
    with torch_seed(seed):
        net = build_network(settings).to(device())
    if initial_weights is not None:
        load_arrays(net, initial_weights)
    loss = partial(image_loss, net, source, settings)
    return net, train(net, loss, split, settings.training, seed, checkpoint)


def predict_clouds(
    images: UInt8[np.ndarray, "n px px 3"],
    rotations: Float[np.ndarray, "n 3 3"],
    settings: AtlasNetSettings,
    state: ModelState,
    seed: int,
) -> list[Float[np.ndarray, "points 3"]]:
    """The prediction from each image: area-uniform points of all patches, in the unit cube.

    The network predicts points @ rotation.
    """
    use_reproducible_kernels()
    net = build_network(settings).to(device()).eval()
    load_arrays(net, state.arrays)
    uv, faces = square_mesh(settings.grid_res)
    squares = torch.tensor(uv.T, dtype=torch.float32, device=device())
    rng = np.random.default_rng(seed)
    tensors = images_to_tensor(images, device())
    meshes = (_vertices(net, image, squares, settings.patches) for image in tensors)
    return [
        sample_patches(vertices @ rotation.T, faces, settings.points, rng)
        for vertices, rotation in zip(meshes, rotations, strict=True)
    ]


@torch.no_grad()
def _vertices(
    net: AtlasNet, image: Float[Tensor, "3 px px"], squares: Float[Tensor, "2 n"], patches: int
) -> Float[np.ndarray, "{patches} n 3"]:
    points = net(image[None], squares[None, :, None].expand(patches, -1, -1, -1))
    return points.view(patches, -1, 3).cpu().numpy().astype(np.float64)


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
