"""The renderer in plain torch: where an equation is changed first, `renderer: torch`.

It is written to be read.  Autograd differentiates whatever stands in `compositing.py`,
`confidence.py`, `sdf_density.py` and `weights.py`, so an edited equation is in force at once, in
training and in confidence; only then does it need a compiled form and a derivative by hand.  It
reconstructs small parts in minutes and any part in hours.  docs/how-to/change-an-equation.md

The compiled kernels are tested against it, in any dtype.  Positions are constants.
"""

import torch
from jaxtyping import Float
from torch import Tensor

from industnerf.rendering.compositing import (
    CompositeOutput,
    composite,
    median_depth,
    opacities,
    terminated_density,
)
from industnerf.rendering.compositing import transmittance as transmittances
from industnerf.rendering.confidence import point_confidence, reduce_samples, voxel_confidence
from industnerf.rendering.points import PointGrid
from industnerf.rendering.render import (
    Corner,
    Rays,
    Renderer,
    RenderOutput,
    require_one_device,
    require_same_rays,
)
from industnerf.rendering.samples import Samples, radiance_points
from industnerf.schema.readings import (
    InterpolationReading,
    OpacityReading,
    SampleReductionReading,
    TransmittanceReading,
)

MAX_CHUNK_NEIGHBORS = 2**22  # along the rays of a chunk: 200 MB of float32 with their colors


class TorchRenderer(Renderer):
    """A `Renderer` of the functions below."""

    def __init__(
        self,
        points: PointGrid,
        lo: Corner,
        hi: Corner,
        step: float,
        early_stop_transmittance: float,
    ) -> None:
        self.points = points
        self._box = tuple(points.positions.new_tensor(corner) for corner in (lo, hi))
        self._step, self._early_stop_transmittance = step, early_stop_transmittance
        self._beta = self.median_beta = 0.0
        self._samples: Samples | None = None  # of the rays rendered last

    def render(
        self, rays: Rays, values: Float[Tensor, "m"], rgb: Float[Tensor, "m 3"]
    ) -> RenderOutput:
        require_one_device(self.points, rays, values)
        points, step = self.points, self._step
        samples = self._samples = radiance_points(
            *(rays.origins, rays.directions, rays.offsets, *self._box, points.positions),
            step=step,
            radius=points.radius,
            k=points.k,
            weights=points.weights,
            is_occupied=points.is_occupied,
        )
        field = samples.mean(torch.cat([values[:, None], rgb], dim=1))
        sigma = self._sigma(field[..., 0], self.beta)
        black = torch.zeros_like(rays.origins)
        output = composite(sigma, field[..., 1:], samples.t, black, step)
        with torch.no_grad():
            median, of_beta = (
                median_depth(self._sigma(field[..., 0], beta), samples.t, step)
                for beta in (self.median_beta, self.beta)
            )
        median = torch.where(median < 0, of_beta, median)
        return RenderOutput(output.rgb, 1 - output.opacity, output.depth, median)

    def _sigma(self, values: Float[Tensor, "r s"], beta: float) -> Float[Tensor, "r s"]:
        """The density of the samples last taken; 0 beyond the end of a ray."""
        sigma = self._samples.sample_density(values, beta)
        return terminated_density(sigma, self._step, self._early_stop_transmittance)

    @torch.no_grad()
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
        require_same_rays(agreement, 0 if self._samples is None else len(self._samples.t))
        chunk = confidence_of_samples(
            self._samples,
            values,
            agreement,
            step=self._step,
            early_stop_transmittance=self._early_stop_transmittance,
            beta=self.beta,
            transmittance=transmittance,
            opacity=opacity,
            samples_reading=samples,
        )
        both = torch.stack([confidence, chunk])
        confidence.copy_(both.sum(dim=0) if samples == "sum" else both.amax(dim=0))

    @property
    def chunk_size(self) -> int:
        diagonal = float((self._box[1] - self._box[0]).norm())
        return max(1, int(MAX_CHUNK_NEIGHBORS / (diagonal / self._step * self.points.k)))

    @property
    def beta(self) -> float:
        return self._beta

    @beta.setter
    def beta(self, beta: float) -> None:
        self._beta = self.median_beta = beta


def render_reference(
    origins: Float[Tensor, "r 3"],
    directions: Float[Tensor, "r 3"],
    offsets: Float[Tensor, "r"],
    lo: Float[Tensor, "3"],
    hi: Float[Tensor, "3"],
    points: Float[Tensor, "m 3"],
    values: Float[Tensor, "m"],
    rgb: Float[Tensor, "m 3"],
    background: Float[Tensor, "r 3"],
    *,
    step: float,
    radius: float,
    k: int,
    weights: InterpolationReading,
    early_stop_transmittance: float,
    beta: float = 0.0,
) -> CompositeOutput:
    """The cloud as the rays see it -- paper, 3.3.

    A radiance point takes the weighted mean value and color of its neighbors.  A ray ends at the
    sample that leaves less than `early_stop_transmittance` of its light (0 = never).  Values are
    densities, or where `beta` is above 0 signed distances.
    """
    samples = radiance_points(
        origins, directions, offsets, lo, hi, points, step=step, radius=radius, k=k, weights=weights
    )
    field = samples.mean(torch.cat([values[:, None], rgb], dim=1))
    sigma = terminated_density(
        samples.sample_density(field[..., 0], beta), step, early_stop_transmittance
    )
    return composite(sigma, field[..., 1:], samples.t, background, step)


def confidence_reference(
    origins: Float[Tensor, "r 3"],
    directions: Float[Tensor, "r 3"],
    offsets: Float[Tensor, "r"],
    lo: Float[Tensor, "3"],
    hi: Float[Tensor, "3"],
    points: Float[Tensor, "m 3"],
    values: Float[Tensor, "m"],
    agreement: Float[Tensor, "r"],
    *,
    step: float,
    radius: float,
    k: int,
    weights: InterpolationReading,
    early_stop_transmittance: float,
    beta: float = 0.0,
    transmittance: TransmittanceReading,
    opacity: OpacityReading,
    samples: SampleReductionReading,
) -> Float[Tensor, "m"]:
    """t of (13) for every cloud point, from all samples of all rays; R9, R15 and R16."""
    ray_samples = radiance_points(
        origins, directions, offsets, lo, hi, points, step=step, radius=radius, k=k, weights=weights
    )
    return confidence_of_samples(
        ray_samples,
        values,
        agreement,
        step=step,
        early_stop_transmittance=early_stop_transmittance,
        beta=beta,
        transmittance=transmittance,
        opacity=opacity,
        samples_reading=samples,
    )


def confidence_of_samples(
    samples: Samples,
    values: Float[Tensor, "m"],
    agreement: Float[Tensor, "r"],
    *,
    step: float,
    early_stop_transmittance: float,
    beta: float,
    transmittance: TransmittanceReading,
    opacity: OpacityReading,
    samples_reading: SampleReductionReading,
) -> Float[Tensor, "m"]:
    """S T_i W_ij / max_j W_ij over the samples of rays of this `agreement`, S of (12).

    R9 and R15 are those of `voxel_confidence`, R16 is that of `reduce_samples`.  Samples beyond
    a ray's end give nothing; a point that is no sample's neighbor has 0.
    """
    sigma = samples.sample_density(samples.mean(values[:, None])[..., 0], beta)
    before = transmittances(sigma, step)[:, :-1]
    voxel = voxel_confidence(
        before * (before >= early_stop_transmittance),
        samples.weights,
        opacities(sigma, step),
        transmittance,
        opacity,
    )
    contributions = point_confidence(agreement, voxel)
    ids = samples.ids.flatten()
    return reduce_samples(contributions.flatten(), ids, len(values), samples_reading)
