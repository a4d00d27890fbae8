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
from industnerf.rendering.nearest import Met
from industnerf.rendering.points import Points
from industnerf.schema.readings import OpacityReading, ReduceReading, TransmittanceReading

CHUNK = 16384  # rays at a time, where there may be more
MOST = 2**31  # neighbours along them: kernels number them in 32 bits


@dataclass(frozen=True)
class Rays:
    """Where to look; `offsets` in [0, 1) shift each ray's samples, 0.5 = the middle of a step."""

    origins: Float[Tensor, "r 3"]
    directions: Float[Tensor, "r 3"]  # unit
    offsets: Float[Tensor, "r"]

    def __len__(self) -> int:
        return len(self.origins)


@dataclass(frozen=True)
class Seen:
    """What rays see of the cloud; a pixel is `colour` + `through` x background."""

    colour: Float[Tensor, "r 3"]
    through: Float[Tensor, "r"]  # share of the light that passes all points
    depth: Float[Tensor, "r"]  # mean distance along the ray of what is not background
    median: Float[Tensor, "r"]  # where half of the light is left, see `median_beta`; -1: never

    def over(self, background: Float[Tensor, "r 3"]) -> Float[Tensor, "r 3"]:
        """The pixels before a background."""
        return self.colour + self.through[:, None] * background


class Renderer:
    """`points` as rays see them that are sampled every `step` inside the box from `lo` to `hi`.

    A ray ends at the sample that leaves less than `stop` of its light.
    """

    def __init__(
        self,
        points: Points,
        lo: tuple[float, float, float],
        hi: tuple[float, float, float],
        step: float,
        stop: float,
    ) -> None:
        self.points = points
        self._march = kernels.March()
        self._march.lo, self._march.hi = wp.vec3(*lo), wp.vec3(*hi)
        self._march.step, self._march.stop = step, stop
        diagonal = sum((b - a) ** 2 for a, b in zip(lo, hi, strict=True)) ** 0.5
        self._march.room = int(diagonal / step) + 2
        self.beta = 0.0
        self._met: tuple | None = None  # rays that fit, `Met`, and the tensors that it points to
        self._looks = self._rays = 0  # how often it has looked, and along how many rays last

    def look(self, rays: Rays, values: Float[Tensor, "m"], rgb: Float[Tensor, "m 3"]) -> Seen:
        """What `rays` see of points that hold `values` and colour `rgb`, differentiable in both.

        Values are densities, or signed distances where `beta` is above 0: `rendering.distance`.
        Not differentiable is the median.
        """
        return Seen(*_Look.apply(values, rgb, self, rays))

    def confide(
        self,
        values: Float[Tensor, "m"],
        agreement: Float[Tensor, "r"],
        confidence: Float[Tensor, "m"],
        *,
        transmittance: TransmittanceReading,
        opacity: OpacityReading,
        samples: ReduceReading,
    ) -> None:
        """Bring (13) of the rays last looked along into `confidence`; R9, R15 and R16.

        Raises RuntimeError if those were not as many as `agreement` is of.
        """
        if len(agreement) != self._rays:
            raise RuntimeError(f"agreement of {len(agreement)} rays, looked along {self._rays}")
        wp.launch(
            kernels.confide,
            dim=len(agreement),
            inputs=[
                self._march,
                self.points.k,
                _numbers(values),
                self._met[1],
                _numbers(agreement),
                transmittance == "own",
                opacity == "with",
                samples == "sum",
                _numbers(confidence),
            ],
            device=self._device,
        )

    @property
    def at_once(self) -> int:
        """How many rays to look along at a time, of any number of them."""
        return min(CHUNK, (MOST - 1) // (self._march.room * self.points.k))

    @property
    def beta(self) -> float:
        """Softness of the surface, if points hold distances; 0 if they hold densities."""
        return self._march.beta

    @beta.setter
    def beta(self, beta: float) -> None:
        self._march.beta = self._march.median_beta = beta

    @property
    def median_beta(self) -> float:
        """Softness of the surface whose median is told; `beta`, unless set after it.

        Where that surface never takes half of a ray's light, the median is of the one of `beta`.
        """
        return self._march.median_beta

    @median_beta.setter
    def median_beta(self, beta: float) -> None:
        self._march.median_beta = beta

    @property
    def _device(self) -> Any:
        return self.points.cells.points.device

    def _met_by(self, rays: int) -> Any:
        """Room for what so many rays or more meet; memory is only used as far as it is filled.

        It is kept for the next rays: to be given fresh pages costs as much as a third of looking.

        Raises ReconstructionFailed if there are more neighbours than 32 bits can number.
        """
        if self._met is None or self._met[0] < rays:
            slots = rays * self._march.room
            if slots * self.points.k >= MOST:
                raise ReconstructionFailed(
                    f"{rays} rays of up to {self._march.room} samples of {self.points.k} "
                    "neighbours are too many to be numbered: lower `rays` or `neighbours`, or "
                    "raise `step` and `fine_step`"
                )
            like = {"device": self.points.positions.device}
            kept = [
                torch.empty(rays, dtype=torch.int32, **like),
                torch.empty(slots, dtype=torch.float32, **like),
                torch.empty(slots, dtype=torch.int32, **like),
                torch.empty(slots * self.points.k, dtype=torch.int32, **like),
                torch.empty(slots * self.points.k, dtype=torch.float32, **like),
            ]
            met = Met()
            met.count, met.at, met.sizes, met.ids, met.weights = map(wp.from_torch, kept)
            self._met = (rays, met, kept)
        return self._met[1]

    def _forward(self, values: Tensor, rgb: Tensor, rays: Rays) -> tuple[Tensor, ...]:
        if {values.device, rays.origins.device} != {self.points.positions.device}:
            raise RuntimeError("points, what they hold and rays are not all on one device")
        self._looks, self._rays = self._looks + 1, len(rays)
        colour = torch.empty_like(rays.origins)
        through, depth, median = (torch.empty_like(rays.offsets) for _ in range(3))
        wp.launch(
            kernels.forward,
            dim=len(rays),
            inputs=[
                self.points.cells,
                self._march,
                _numbers(values),
                _vectors(rgb),
                _vectors(rays.origins),
                _vectors(rays.directions),
                _numbers(rays.offsets),
                self._met_by(len(rays)),
                _vectors(colour),
                _numbers(through),
                _numbers(depth),
                _numbers(median),
            ],
            device=self._device,
        )
        return colour, through, depth, median

    def _backward(
        self, values: Tensor, rgb: Tensor, seen: Sequence[Tensor], d_seen: Sequence[Tensor]
    ) -> tuple[Tensor, Tensor]:
        d_values, d_rgb = torch.zeros_like(values), torch.zeros_like(rgb)
        (colour, through, depth), (d_colour, d_through, d_depth) = seen, d_seen
        wp.launch(
            kernels.backward,
            dim=len(colour),
            inputs=[
                self._march,
                self.points.k,
                _numbers(values),
                _vectors(rgb),
                self._met[1],
                _vectors(colour),
                _numbers(through),
                _numbers(depth),
                _vectors(d_colour),
                _numbers(d_through),
                _numbers(d_depth),
                _numbers(d_values),
                _vectors(d_rgb),
            ],
            device=self._device,
        )
        return d_values, d_rgb


class _Look(torch.autograd.Function):
    """The way back must follow before the renderer looks along other rays: it keeps one record.

    `backward` raises RuntimeError if it did not.
    """

    @staticmethod
    def forward(ctx, values, rgb, renderer, rays):
        colour, through, depth, median = renderer._forward(values, rgb, rays)
        ctx.save_for_backward(values, rgb, colour, through, depth)
        ctx.renderer, ctx.look = renderer, renderer._looks
        ctx.mark_non_differentiable(median)
        return colour, through, depth, median

    @staticmethod
    def backward(ctx, d_colour, d_through, d_depth, d_median):
        if ctx.look != ctx.renderer._looks:
            raise RuntimeError("the renderer has looked along other rays since")
        values, rgb, *seen = ctx.saved_tensors
        d_seen = d_colour, d_through, d_depth
        return *ctx.renderer._backward(values, rgb, seen, d_seen), None, None


def _numbers(values: Tensor) -> Any:
    return _handed(values, wp.float32)


def _vectors(values: Tensor) -> Any:
    return _handed(values, wp.vec3)


def _handed(values: Tensor, dtype: type) -> Any:
    """For a kernel that is launched at once: where the numbers are, and no more."""
    return wp.from_torch(values.detach().contiguous(), dtype, return_ctype=True)
