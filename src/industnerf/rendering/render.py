"""Points and rays to pixels, differentiable: section 3.3 on the compiled kernels."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import torch
import warp as wp
from jaxtyping import Float
from torch import Tensor

from industnerf.errors import ReconstructionFailed
from industnerf.rendering import kernels
from industnerf.rendering.neighbor_search_kernel import NeighborBuffer
from industnerf.rendering.points import PointGrid
from industnerf.schema.readings import OpacityReading, SampleReductionReading, TransmittanceReading

MAX_CHUNK = 16384  # rays at a time, where there may be more
MAX_NEIGHBORS = 2**31  # neighbors along them: kernels number them in 32 bits


@dataclass(frozen=True)
class Rays:
    """Where to look; `offsets` in [0, 1) shift each ray's samples, 0.5 = the middle of a step."""

    origins: Float[Tensor, "r 3"]
    directions: Float[Tensor, "r 3"]  # unit
    offsets: Float[Tensor, "r"]

    def __len__(self) -> int:
        return len(self.origins)


@dataclass(frozen=True)
class RenderOutput:
    """What rays see of the cloud; a pixel is `color` + `through` x background."""

    color: Float[Tensor, "r 3"]
    transmittance: Float[Tensor, "r"]  # share of the light that passes all points
    depth: Float[Tensor, "r"]  # mean distance along the ray of what is not background
    median_depth: Float[
        Tensor, "r"
    ]  # where half of the light is left, see `median_beta`; -1: never

    def composite_over(self, background: Float[Tensor, "r 3"]) -> Float[Tensor, "r 3"]:
        """The pixels before a background."""
        return self.color + self.transmittance[:, None] * background


class Renderer:
    """`points` as rays see them that are sampled every `step` inside the box from `lo` to `hi`.

    A ray ends at the sample that leaves less than `stop` of its light.
    """

    def __init__(
        self,
        points: PointGrid,
        lo: tuple[float, float, float],
        hi: tuple[float, float, float],
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
        self._buffer: tuple | None = None  # rays that fit, `Met`, and the tensors that it points to
        self._render_count = self._num_rays = (
            0  # how often it has looked, and along how many rays last
        )

    def render(
        self, rays: Rays, values: Float[Tensor, "m"], rgb: Float[Tensor, "m 3"]
    ) -> RenderOutput:
        """What `rays` see of points that hold `values` and color `rgb`, differentiable in both.

        Values are densities, or signed distances where `beta` is above 0: `rendering.distance`.
        Not differentiable is the median.
        """
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
        """Bring (13) of the rays last looked along into `confidence`; R9, R15 and R16.

        Raises RuntimeError if those were not as many as `agreement` is of.
        """
        if len(agreement) != self._num_rays:
            raise RuntimeError(f"agreement of {len(agreement)} rays, looked along {self._num_rays}")
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
        """How many rays to look along at a time, of any number of them."""
        return min(MAX_CHUNK, (MAX_NEIGHBORS - 1) // (self._params.max_samples * self.points.k))

    @property
    def beta(self) -> float:
        """Softness of the surface, if points hold distances; 0 if they hold densities."""
        return self._params.beta

    @beta.setter
    def beta(self, beta: float) -> None:
        self._params.beta = self._params.median_beta = beta

    @property
    def median_beta(self) -> float:
        """Softness of the surface whose median is told; `beta`, unless set after it.

        Where that surface never takes half of a ray's light, the median is of the one of `beta`.
        """
        return self._params.median_beta

    @median_beta.setter
    def median_beta(self, beta: float) -> None:
        self._params.median_beta = beta

    @property
    def _device(self) -> Any:
        return self.points.cells.points.device

    def _neighbor_buffer(self, num_rays: int) -> Any:
        """Room for what so many rays or more meet; memory is only used as far as it is filled.

        It is kept for the next rays: to be given fresh pages costs as much as a third of looking.

        Raises ReconstructionFailed if there are more neighbors than 32 bits can number.
        """
        if self._buffer is None or self._buffer[0] < num_rays:
            slots = num_rays * self._params.max_samples
            if slots * self.points.k >= MAX_NEIGHBORS:
                raise ReconstructionFailed(
                    f"{num_rays} rays of up to {self._params.max_samples} samples of {self.points.k} "
                    "neighbors are too many to be numbered: lower `rays` or `neighbors`, or "
                    "raise `step` and `fine_step`"
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
        if {values.device, rays.origins.device} != {self.points.positions.device}:
            raise RuntimeError("points, what they hold and rays are not all on one device")
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
    """The way back must follow before the renderer looks along other rays: it keeps one record.

    `backward` raises RuntimeError if it did not.
    """

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
            raise RuntimeError("the renderer has looked along other rays since")
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
