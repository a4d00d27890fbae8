"""Cloud points sorted into cells, and the empty space between them: where kernels look up."""

import math

import numpy as np
import torch
import warp as wp
from jaxtyping import Bool, Float
from scipy.ndimage import distance_transform_cdt
from torch import Tensor

from industnerf.errors import ReconstructionFailed
from industnerf.rendering.neighbor_search_kernel import CellGrid, mark_occupied
from industnerf.schema.readings import InterpolationReading

READINGS: dict[InterpolationReading, int] = {
    "inverse": 0,
    "inverse_square": 1,
    "modified_shepard": 2,
    "trilinear": 3,
}
MAX_CELLS = 2**27  # 1.5 GB while they are sorted
GRID_TOLERANCE = 1e-4  # radii that a point of a grid may be off, along each axis: roundings
MAX_CELL_DISTANCE = 255  # cells: the most that a byte holds


class PointGrid:
    """A cloud in an order that lies well in memory: `positions` are the given ones [`order`].

    Raises ReconstructionFailed if so small a radius has more cells than fit into memory.
    """

    def __init__(
        self, positions: Float[Tensor, "m 3"], radius: float, k: int, weights: InterpolationReading
    ) -> None:
        corner = positions.amin(0) - 2.5 * radius  # empty cells all round: neighbors exist
        size = ((positions.amax(0) - corner) / radius).long() + 4
        if (count := math.prod(size.tolist())) > MAX_CELLS:
            raise ReconstructionFailed(
                f"the points span {count} cells of the neighbors' radius, at most {MAX_CELLS} "
                "fit into memory: raise `neighbor_radius`, or lower `grid_res` or the number of levels"
            )
        cell = ((positions - corner) / radius).long()
        key, self.order = torch.sort(
            (cell[:, 0] * size[1] + cell[:, 1]) * size[2] + cell[:, 2], stable=True
        )
        self.positions = positions[self.order].contiguous()
        all_cells = torch.arange(int(size.prod()) + 1, device=key.device)
        self._first = torch.searchsorted(key, all_cells).int()
        self._size = tuple(size.tolist())
        self.radius, self.k, self.weights = radius, k, weights
        self.cells = CellGrid()
        self.cells.points = wp.from_torch(self.positions, dtype=wp.vec3)
        self.cells.first = wp.from_torch(self._first)
        self.cells.corner = wp.vec3(*corner.tolist())
        self.cells.nx, self.cells.ny, self.cells.nz = self._size
        self.cells.radius, self.cells.k, self.cells.reading = radius, k, READINGS[weights]
        self.cells.is_grid_aligned = (
            weights == "trilinear" and k >= 8 and self._is_grid_aligned(corner)
        )
        self.update_occupancy(torch.ones(len(positions), dtype=torch.bool, device=positions.device))

    def __len__(self) -> int:
        return len(self.positions)

    def _is_grid_aligned(self, corner: Float[Tensor, "3"]) -> bool:
        """Whether each point stands in the middle of a cell, and alone: up to GRID_TOLERANCE."""
        offset = ((self.positions - corner) / self.radius).frac() - 0.5
        return bool(offset.abs().max() < GRID_TOLERANCE and self._first.diff().max() <= 1)

    @property
    def support_radius(self) -> float:
        """How far a neighbor can be; trilinear weights reach the corners of a cube."""
        return self.radius * (3**0.5 if self.weights == "trilinear" else 1)

    def update_occupancy(self, occupied: Bool[Tensor, "m"]) -> None:
        """From now on rays skip cells without an occupied point within the radius.

        This changes no pixel while the other points have no density.
        """
        is_near = torch.zeros(len(self._first) - 1, dtype=torch.uint8, device=self._first.device)
        points = self.positions[occupied].contiguous()
        wp.launch(
            mark_occupied,
            dim=len(points),
            inputs=[wp.from_torch(points, dtype=wp.vec3), self.cells, wp.from_torch(is_near)],
            device=self.cells.points.device,
        )
        empty = is_near.reshape(self._size).cpu().numpy() == 0
        distance = (
            np.minimum(distance_transform_cdt(empty, "chessboard"), MAX_CELL_DISTANCE)
            if len(points)
            else np.full(self._size, MAX_CELL_DISTANCE)
        )
        self._distance_to_occupied = torch.from_numpy(distance.astype(np.uint8).ravel()).to(
            is_near.device
        )
        self.cells.distance_to_occupied = wp.from_torch(self._distance_to_occupied)

    def is_occupied(self, positions: Float[Tensor, "q 3"]) -> Bool[Tensor, "q"]:
        """Whether rays look for neighbors there: `cell_at` and `update_occupancy`, in torch."""
        corner = positions.new_tensor(list(self.cells.corner))
        size = torch.tensor(self._size, device=positions.device)
        cell = ((positions - corner) / self.radius).clamp(min=1).long().minimum(size - 2)
        index = (cell[:, 0] * size[1] + cell[:, 1]) * size[2] + cell[:, 2]
        return self._distance_to_occupied[index] == 0
