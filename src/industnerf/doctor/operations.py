"""Operations that reconstructions are made of, by library: which of them gives other bytes here."""

from collections.abc import Callable

import numpy as np
import torch
from scipy.ndimage import gaussian_filter
from scipy.spatial import cKDTree
from torch import nn
from torch.nn.functional import normalize, softplus

from industnerf.geometry.raycast import RaycastingScene

Arrays = list[np.ndarray]


def _normal(*shape: int) -> np.ndarray:
    return np.random.default_rng(sum(shape)).standard_normal(shape)


def _numpy_functions() -> Arrays:
    x = _normal(40, 50)
    return [np.exp(x), np.sin(x), np.log(abs(x)), np.arctan2(x, x[::-1]), abs(x) ** 0.3]


def _numpy_sorts() -> Arrays:
    x = _normal(2000).round(1)  # ties, which kernels order differently
    return [np.argsort(x), np.argpartition(x, 100), np.argsort(x.astype(np.float32))]


def _numpy_products() -> Arrays:
    x = _normal(60, 80)
    return [x @ x.T, x.astype(np.float32) @ x.T.astype(np.float32), *np.linalg.svd(x)]


def _scipy() -> Arrays:
    return [gaussian_filter(_normal(40, 50), 2), *cKDTree(_normal(500, 3)).query(_normal(90, 3), 5)]


def _rays() -> Arrays:
    """At random triangles, whose faces cross: both ways of casting."""
    corners = _normal(60, 1, 3) + 0.3 * _normal(60, 3, 3)
    faces = np.arange(180, dtype=np.int32).reshape(60, 3)
    scene = RaycastingScene(corners.reshape(-1, 3), faces)
    directions = _normal(5000, 3).astype(np.float32)
    hits = scene.cast(np.zeros((1, 3)), directions)
    packets = scene.cast_from(np.full(3, 0.5), directions)
    return [hits.t, hits.face, hits.uv, packets.ray, packets.t, packets.face, packets.uv]


def _torch_functions() -> Arrays:
    x = torch.from_numpy(_normal(40, 50)).float()
    roots, powers = [x.abs().sqrt(), normalize(x)], [x.exp(), x.abs().log(), x.abs() ** 0.3]
    return _arrays(*roots, *powers, x.sin(), x.tanh(), x.sigmoid(), softplus(x), x.softmax(1))


def _torch_sums() -> Arrays:
    x = torch.from_numpy(_normal(40, 50)).float()
    return _arrays(x.sum(), x.sum(0), x.mean(1), x.var(), x.cumsum(1))


def _torch_products() -> Arrays:
    layer = nn.Linear(40, 30)
    return _gradients(layer, torch.from_numpy(_normal(500, 40)).float())


def _torch_convolutions() -> Arrays:
    images = torch.from_numpy(_normal(2, 3, 32, 32)).float()
    voxels = torch.from_numpy(_normal(2, 8, 8, 8, 8)).float()
    return [
        *_gradients(nn.Sequential(nn.Conv2d(3, 16, 6, 2, 2), nn.Conv2d(16, 16, 3)), images),
        *_gradients(nn.Conv3d(8, 8, 3), voxels),
    ]


def _torch_norms() -> Arrays:
    return _gradients(nn.BatchNorm2d(3), torch.from_numpy(_normal(2, 3, 32, 32)).float())


def _torch_random() -> Arrays:
    generator = torch.Generator().manual_seed(0)
    numbers = torch.randn(100, generator=generator), torch.rand(100, generator=generator)
    return _arrays(*numbers, torch.randperm(100, generator=generator))


def _torch_adam() -> Arrays:
    parameter = nn.Parameter(torch.from_numpy(_normal(300)).float())
    optimizer = torch.optim.Adam([parameter], lr=0.01)
    for _ in range(5):
        optimizer.zero_grad()
        parameter.square().sum().backward()
        optimizer.step()
    return _arrays(parameter)


def _gradients(module: nn.Module, x: torch.Tensor) -> Arrays:
    """Output and all gradients of its squared sum; weights come from torch's own generator."""
    torch.manual_seed(0)
    for parameter in module.parameters():
        nn.init.normal_(parameter)
    x.requires_grad_()
    output = module(x)
    output.square().sum().backward()
    return _arrays(output, x.grad, *(parameter.grad for parameter in module.parameters()))


def _arrays(*tensors: torch.Tensor | None) -> Arrays:
    return [tensor.detach().numpy() for tensor in tensors if tensor is not None]


OPERATIONS: dict[str, Callable[[], Arrays]] = {
    "functions of numpy": _numpy_functions,
    "sorts of numpy": _numpy_sorts,
    "matrix products of numpy": _numpy_products,
    "filters and trees of scipy": _scipy,
    "rays of embree": _rays,
    "functions of torch": _torch_functions,
    "sums of torch": _torch_sums,
    "matrix products of torch": _torch_products,
    "convolutions of torch": _torch_convolutions,
    "batch norms of torch": _torch_norms,
    "random numbers of torch": _torch_random,
    "Adam of torch": _torch_adam,
}
