"""Dual potentials: which of the many that are optimal on few pairs are chosen.

An optimal plan leaves the potentials a wide choice, and the simplex returns an extreme one, which
other pairs are likely to violate.  The choice here stays close to the potentials before: those
began as smooth functions in space that few pairs violate.
"""

import numpy as np
from jaxtyping import Float64, Int64
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra


def row_minimum(
    slack: Float64[np.ndarray, "k"], rows: Int64[np.ndarray, "k"]
) -> Float64[np.ndarray, "n"]:
    """The least `slack` of each row; `rows` ascends and leaves none out."""
    return np.minimum.reduceat(slack, np.flatnonzero(np.diff(rows, prepend=-1)))


def center_potentials(
    pairs: tuple[Int64[np.ndarray, "k"], Int64[np.ndarray, "k"]],
    reduced: Float64[np.ndarray, "k"],
    support: tuple[Int64[np.ndarray, "f"], Int64[np.ndarray, "f"]],
    potentials: tuple[Float64[np.ndarray, "n"], Float64[np.ndarray, "m"]],
) -> tuple[Float64[np.ndarray, "n"], Float64[np.ndarray, "m"]]:
    """Optimal potentials nearest to 0 with u <= 0 and v >= 0, given any optimal ones.

    Optimal on `pairs` of costs `reduced`: u_i + v_j <= reduced_ij, with equality on `support`.

    With the changes u + x and v - y, each condition is an edge of a graph:
    x_i <= y_j + (slack of the pair), y_j <= x_i on the support, and x <= -u, y <= v.  The largest
    x, y are shortest distances.
    """
    (rows, cols), (sources, targets), (u, v) = pairs, support, potentials
    n, nodes = len(u), np.arange(len(u) + len(v))
    upper_bounds = np.concatenate([-u, v])
    slack = np.maximum(reduced - u[rows] - v[cols], 0.0)  # 0 but for rounding
    root = np.full(len(nodes), len(nodes))
    tails = np.concatenate([cols + n, sources, root])
    heads = np.concatenate([rows, targets + n, nodes])
    lengths = np.concatenate([slack, np.zeros(len(sources)), upper_bounds - upper_bounds.min()])
    graph = csr_array((lengths, (tails, heads)), shape=(len(nodes) + 1, len(nodes) + 1))
    decrease = dijkstra(graph, indices=len(nodes))[:-1] + upper_bounds.min()
    return u + decrease[:n], v - decrease[n:]
