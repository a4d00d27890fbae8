"""Nearest points of two clouds, by all distances, compiled: a third of a KD-tree's time or less.

One pass serves both directions.  A distance and an index are compared as one integer: the bits
of a positive float are ordered as it is, and its lowest ones make room for the index.  So the
loop has no branch, and a compiler makes it a loop of vectors.  Points whose squared distances
differ by less than a part in 2^(23 - bits) are equally near: the lower index wins.
"""

from typing import no_type_check  # compiled, not called: there is nothing to check

import numpy as np
import torch
import warp as wp
from jaxtyping import Float, Int
from torch import Tensor

from industnerf.geometry.warp_runtime import init_warp

init_warp()

NEAREST = """
    const int mask = (1 << bits) - 1;
    const float* __restrict__ px = a.data + size_t(pair) * 3 * n;
    const float* __restrict__ py = px + n;
    const float* __restrict__ pz = py + n;
    const float* __restrict__ qx = b.data + size_t(pair) * 3 * m;
    const float* __restrict__ qy = qx + m;
    const float* __restrict__ qz = qy + m;
    int* __restrict__ row = a_to_b.data + size_t(pair) * n;
    int* __restrict__ column = b_to_a.data + size_t(pair) * m;
    for (int j = 0; j < m; ++j) column[j] = 0x7fffffff;
    for (int i = 0; i < n; ++i) {
        const float x = px[i], y = py[i], z = pz[i];
        int best = 0x7fffffff;
        for (int j = 0; j < m; ++j) {
            const float dx = qx[j] - x, dy = qy[j] - y, dz = qz[j] - z;
            union { float value; int bits; } square;
            square.value = dx * dx + dy * dy + dz * dz;
            const int rounded = square.bits & ~mask;
            best = (rounded | j) < best ? rounded | j : best;
            column[j] = (rounded | i) < column[j] ? rounded | i : column[j];
        }
        row[i] = best & mask;
    }
    for (int j = 0; j < m; ++j) column[j] &= mask;
"""


@wp.func_native(NEAREST)
@no_type_check
def search_pair(
    a: wp.array(dtype=wp.float32),
    b: wp.array(dtype=wp.float32),
    n: wp.int32,
    m: wp.int32,
    bits: wp.int32,
    pair: wp.int32,
    a_to_b: wp.array(dtype=wp.int32),
    b_to_a: wp.array(dtype=wp.int32),
): ...


@wp.kernel
@no_type_check
def search_pairs(
    a: wp.array(dtype=wp.float32),
    b: wp.array(dtype=wp.float32),
    n: wp.int32,
    m: wp.int32,
    bits: wp.int32,
    a_to_b: wp.array(dtype=wp.int32),
    b_to_a: wp.array(dtype=wp.int32),
):
    """One thread a pair of clouds."""
    search_pair(a, b, n, m, bits, wp.tid(), a_to_b, b_to_a)


def nearest_compiled(
    a: Float[Tensor, "b n 3"], b: Float[Tensor, "b m 3"]
) -> tuple[Int[Tensor, "b n"], Int[Tensor, "b m"]]:
    """For each point of a cloud on the CPU the nearest of the other's."""
    (batch, n, _), m = a.shape, b.shape[1]
    clouds = [
        wp.array(x.transpose(1, 2).contiguous().float().numpy().ravel(), wp.float32, device="cpu")
        for x in (a, b)
    ]
    found = [np.empty((batch, count), np.int32) for count in (n, m)]
    outputs = [wp.array(x.ravel(), dtype=wp.int32, device="cpu", copy=False) for x in found]
    bits = (max(n, m) - 1).bit_length()
    wp.launch(search_pairs, batch, [*clouds, n, m, bits], outputs, device="cpu")
    a_to_b, b_to_a = (torch.from_numpy(x).long() for x in found)
    return a_to_b, b_to_a
