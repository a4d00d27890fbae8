"""Points and rays to pixels, differentiable -- paper, section 3.3: what every back end offers."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

from jaxtyping import Float
from torch import Tensor

from industnerf.rendering.points import PointGrid
from industnerf.schema.industnerf import RendererName
from industnerf.schema.readings import OpacityReading, SampleReductionReading, TransmittanceReading

Corner = tuple[float, float, float]


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
    """What rays see of the cloud."""

    color: Float[Tensor, "r 3"]  # without the background
    transmittance: Float[Tensor, "r"]  # share of the light that passes all points
    depth: Float[Tensor, "r"]  # mean distance along the ray of what is not background
    median_depth: Float[Tensor, "r"]  # where half of the light is left; -1: nowhere

    def composite_over(self, background: Float[Tensor, "r 3"]) -> Float[Tensor, "r 3"]:
        """The pixels in front of a background."""
        return self.color + self.transmittance[:, None] * background


class Renderer(ABC):
    """`points`, seen along rays that are sampled at regular steps inside a box."""

    points: PointGrid
    beta: float  # softness of the surface if points hold distances; 0 if they hold densities
    median_beta: float  # the same, for the median depth alone; assigning `beta` assigns both

    @abstractmethod
    def render(
        self, rays: Rays, values: Float[Tensor, "m"], rgb: Float[Tensor, "m 3"]
    ) -> RenderOutput:
        """What `rays` see of points of these values and colors, differentiable in both.

        Values are densities, or signed distances where `beta` is above 0: `sdf_density`.  The
        median depth is of the surface that `median_beta` makes, or where that one never takes
        half of the light, of the one of `beta`; it has no gradient.

        Raises RuntimeError if points, values and rays are not on one device.
        """

    @abstractmethod
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
        """Bring (13) of the rays that were rendered last into `confidence`; R9, R15 and R16.

        Raises RuntimeError if those were not as many as `agreement` is of.
        """

    @property
    @abstractmethod
    def chunk_size(self) -> int:
        """How many rays to render at a time, of any number of them."""


def make_renderer(
    name: RendererName,
    points: PointGrid,
    lo: Corner,
    hi: Corner,
    step: float,
    early_stop_transmittance: float,
) -> Renderer:
    """The back end of that name: samples every `step` inside the box from `lo` to `hi`.

    A ray ends at the sample that leaves less than `early_stop_transmittance` of its light.
    """
    if name == "torch":
        from industnerf.rendering.torch_renderer import TorchRenderer as BackEnd
    else:
        from industnerf.rendering.compiled_renderer import CompiledRenderer as BackEnd
    return BackEnd(points, lo, hi, step, early_stop_transmittance)


def require_same_rays(agreement: Float[Tensor, "r"], num_rays: int) -> None:
    """RuntimeError if confidence is asked for along other rays than were rendered last."""
    if len(agreement) != num_rays:
        raise RuntimeError(f"agreement of {len(agreement)} rays, {num_rays} were rendered")


def require_one_device(points: PointGrid, rays: Rays, values: Tensor) -> None:
    """RuntimeError if a back end would have to look for its numbers on two devices."""
    if {values.device, rays.origins.device} != {points.positions.device}:
        raise RuntimeError("points, their values and rays are not all on one device")
