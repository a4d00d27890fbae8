"""The renderer on the compiled kernels: what reconstructions use, `renderer: compiled`."""

from collections.abc import Sequence
from typing import Any

import torch
import warp as wp
from jaxtyping import Float
from torch import Tensor

from industnerf.errors import ReconstructionFailed
from industnerf.rendering import kernels
from industnerf.rendering.neighbor_search_kernel import NeighborBuffer
from industnerf.rendering.points import PointGrid
from industnerf.rendering.render import (
    Corner,
    Rays,
    Renderer,
    RenderOutput,
    require_one_device,
    require_same_rays,
)
from industnerf.schema.readings import OpacityReading, SampleReductionReading, TransmittanceReading

MAX_CHUNK = 16384  # rays at a time, where there may be more
MAX_NEIGHBORS = 2**31  # neighbors along them: kernels number them in 32 bits


class CompiledRenderer(Renderer):
    """A `Renderer` that keeps one record of the neighbors along the rays it rendered last."""

    def __init__(
        self,
        points: PointGrid,
        lo: Corner,
        hi: Corner,
        step: float,
        early_stop_transmittance: float,
    ) -> None:
        self.points = points
        self._params = kernels.RayMarchParams()
        self._params.lo, self._params.hi = wp.vec3(*lo), wp.vec3(*hi)
        self._params.step, self._params.early_stop_transmittance = step, early_stop_transmittance
        diagonal = sum((b - a) ** 2 for a, b in zip(lo, hi, strict=True)) ** 0.5
        self._params.max_samples = int(diagonal / step) + 2
        self.beta = 0.0
        # rays that fit, the `NeighborBuffer`, and the tensors that it points to
        self._buffer: tuple | None = None
        self._render_count = self._num_rays = 0  # how often it rendered, and how many rays last

    def render(
        self, rays: Rays, values: Float[Tensor, "m"], rgb: Float[Tensor, "m 3"]
    ) -> RenderOutput:
        return RenderOutput(*_RenderFunction.apply(values, rgb, self, rays))

    def accumulate_confidence(
        self,
        values: Float[Tensor, "m"],
        agreement: Float[Tensor, "r"],
        confidence: Float[Tensor, "m"],
        *,
        transmittance: TransmittanceReading,
        opacity: OpacityReading,
        samples: SampleReductionReading,
    ) -> None:
        require_same_rays(agreement, self._num_rays)
        wp.launch(
            kernels.accumulate_confidence,
            dim=len(agreement),
            inputs=[
                self._params,
                self.points.k,
                _as_floats(values),
                self._buffer[1],
                _as_floats(agreement),
                transmittance == "own",
                opacity == "with",
                samples == "sum",
                _as_floats(confidence),
            ],
            device=self._device,
        )

    @property
    def chunk_size(self) -> int:
        return min(MAX_CHUNK, (MAX_NEIGHBORS - 1) // (self._params.max_samples * self.points.k))

    @property
    def beta(self) -> float:
        return self._params.beta

    @beta.setter
    def beta(self, beta: float) -> None:
        self._params.beta = self._params.median_beta = beta

    @property
    def median_beta(self) -> float:
        return self._params.median_beta

    @median_beta.setter
    def median_beta(self, beta: float) -> None:
        self._params.median_beta = beta

    @property
    def _device(self) -> Any:
        return self.points.cells.points.device

    def _neighbor_buffer(self, num_rays: int) -> Any:
        """Room for the neighbors of so many rays or more; only what is filled takes memory.

        It is kept for the next rays: fresh pages cost as much as a third of rendering.

        Raises ReconstructionFailed if there are more neighbors than 32 bits can number.
        """
        if self._buffer is None or self._buffer[0] < num_rays:
            slots = num_rays * self._params.max_samples
            if slots * self.points.k >= MAX_NEIGHBORS:
                raise ReconstructionFailed(
                    f"{num_rays} rays of up to {self._params.max_samples} samples of "
                    f"{self.points.k} neighbors are too many to be numbered: lower `rays_per_step` "
                    "or `neighbors`, or raise `step_size` and `fine_step_size`"
                )
            options = {"device": self.points.positions.device}
            arrays = [
                torch.empty(num_rays, dtype=torch.int32, **options),
                torch.empty(slots, dtype=torch.float32, **options),
                torch.empty(slots, dtype=torch.int32, **options),
                torch.empty(slots * self.points.k, dtype=torch.int32, **options),
                torch.empty(slots * self.points.k, dtype=torch.float32, **options),
            ]
            buffer = NeighborBuffer()
            buffer.sample_counts, buffer.t, buffer.neighbor_counts, buffer.ids, buffer.weights = (
                map(wp.from_torch, arrays)
            )
            self._buffer = (num_rays, buffer, arrays)
        return self._buffer[1]

    def _forward(self, values: Tensor, rgb: Tensor, rays: Rays) -> tuple[Tensor, ...]:
        require_one_device(self.points, rays, values)
        self._render_count, self._num_rays = self._render_count + 1, len(rays)
        color = torch.empty_like(rays.origins)
        transmittance, depth, median = (torch.empty_like(rays.offsets) for _ in range(3))
        wp.launch(
            kernels.forward,
            dim=len(rays),
            inputs=[
                self.points.cells,
                self._params,
                _as_floats(values),
                _as_vectors(rgb),
                _as_vectors(rays.origins),
                _as_vectors(rays.directions),
                _as_floats(rays.offsets),
                self._neighbor_buffer(len(rays)),
                _as_vectors(color),
                _as_floats(transmittance),
                _as_floats(depth),
                _as_floats(median),
            ],
            device=self._device,
        )
        return color, transmittance, depth, median

    def _backward(
        self, values: Tensor, rgb: Tensor, outputs: Sequence[Tensor], d_outputs: Sequence[Tensor]
    ) -> tuple[Tensor, Tensor]:
        d_values, d_rgb = torch.zeros_like(values), torch.zeros_like(rgb)
        (color, transmittance, depth), (d_color, d_transmittance, d_depth) = outputs, d_outputs
        wp.launch(
            kernels.backward,
            dim=len(color),
            inputs=[
                self._params,
                self.points.k,
                _as_floats(values),
                _as_vectors(rgb),
                self._buffer[1],
                _as_vectors(color),
                _as_floats(transmittance),
                _as_floats(depth),
                _as_vectors(d_color),
                _as_floats(d_transmittance),
                _as_floats(d_depth),
                _as_floats(d_values),
                _as_vectors(d_rgb),
            ],
            device=self._device,
        )
        return d_values, d_rgb


class _RenderFunction(torch.autograd.Function):
    """`backward` raises RuntimeError if the renderer has rendered other rays since `forward`."""

    @staticmethod
    def forward(ctx, values, rgb, renderer, rays):
        color, transmittance, depth, median = renderer._forward(values, rgb, rays)
        ctx.save_for_backward(values, rgb, color, transmittance, depth)
        ctx.renderer, ctx.render_count = renderer, renderer._render_count
        ctx.mark_non_differentiable(median)
        return color, transmittance, depth, median

    @staticmethod
    def backward(ctx, d_color, d_transmittance, d_depth, d_median):
        if ctx.render_count != ctx.renderer._render_count:
            raise RuntimeError("the renderer has rendered other rays since")
        values, rgb, *outputs = ctx.saved_tensors
        d_outputs = d_color, d_transmittance, d_depth
        return *ctx.renderer._backward(values, rgb, outputs, d_outputs), None, None


def _as_floats(values: Tensor) -> Any:
    return _to_warp(values, wp.float32)


def _as_vectors(values: Tensor) -> Any:
    return _to_warp(values, wp.vec3)


def _to_warp(values: Tensor, dtype: type) -> Any:
    """For a kernel that is launched at once: where the numbers are, and no more."""
    return wp.from_torch(values.detach().contiguous(), dtype, return_ctype=True)
