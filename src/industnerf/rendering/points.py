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
GRID_TOLERANCE = 1e-4  # radii that a point of a lattice may be off, along each axis: roundings
MAX_CELL_DISTANCE = 255  # cells that a byte can say space is empty


class PointGrid:
    """A cloud in an order that lies well in memory: `positions` are the given ones [`order`].

    Raises ReconstructionFailed if so small a radius has more cells than fit into memory.
    """

    def __init__(
        self, positions: Float[Tensor, "m 3"], radius: float, k: int, weights: InterpolationReading
    ) -> None:
        corner = positions.amin(0) - 2.5 * radius  # cells all round, so that none has to be asked
        size = ((positions.amax(0) - corner) / radius).long() + 4
        if (count := math.prod(size.tolist())) > MAX_CELLS:
            raise ReconstructionFailed(
                f"the points span {count} cells of the neighbors' radius, at most {MAX_CELLS} "
                "fit into memory: raise `radius`, or lower `grid_res` or the number of levels"
            )
        cell = ((positions - corner) / radius).long()
        key, self.order = torch.sort(
            (cell[:, 0] * size[1] + cell[:, 1]) * size[2] + cell[:, 2], stable=True
        )
        self.positions = positions[self.order].contiguous()
        all_cells = torch.arange(int(size.prod()) + 1, device=key.device)
        self._first = torch.searchsorted(key, all_cells).int()
        self._size = tuple(size.tolist())
        self.radius, self.k = radius, k
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
        """Whether each point stands in the middle of a cell, and alone: up to OFF radii."""
        offset = ((self.positions - corner) / self.radius).frac() - 0.5
        return bool(offset.abs().max() < GRID_TOLERANCE and self._first.diff().max() <= 1)

    @property
    def support_radius(self) -> float:
        """How far a neighbor can be: tents stand on a cube, whose corners are farther."""
        return self.radius * (3**0.5 if self.cells.reading == READINGS["trilinear"] else 1)

    def update_occupancy(self, occupied: Bool[Tensor, "m"]) -> None:
        """From now on rays skip space without a `filled` point within the radius.

        This changes no pixel while the others have no density.
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
