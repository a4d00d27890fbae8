"""Learning the field of one level: re-rendering the source views is the only signal, R10."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import torch
from jaxtyping import Bool, Float32, Int64
from torch import Tensor

from industnerf.errors import ReconstructionFailed
from industnerf.methods.industnerf.carving import Silhouettes
from industnerf.methods.industnerf.field import Field
from industnerf.methods.industnerf.levels import Layer, name_of, near_any, spacing_of
from industnerf.methods.industnerf.losses import error, off_depth, preference
from industnerf.methods.industnerf.optimiser import FieldAdam
from industnerf.methods.industnerf.photohull import PhotoHull
from industnerf.methods.industnerf.pixels import Pixels, footprint, noisier
from industnerf.methods.industnerf.relief import Relief, beside_on_grid
from industnerf.methods.industnerf.roles import view_roles
from industnerf.methods.industnerf.scene import Scene
from industnerf.methods.industnerf.schedule import level_of, progress, softness
from industnerf.methods.industnerf.witnesses import Testimony, testimony
from industnerf.rendering.distance import density
from industnerf.rendering.points import Points
from industnerf.rendering.render import Renderer, Seen
from industnerf.schema import IndustnerfSettings

SWEEP = 20  # steps from one look at all points, and at all views, to the next; one at the end
OUTLINE = 1.0  # first spacings beyond the hull: no pixel that is farther tells anything new
CROWD = 0.9  # of the points; if more are needed, sorting out the rest is not worth it


@dataclass(frozen=True)
class Glance:
    """What was seen along some rays, and what should have been."""

    seen: Seen
    background: Float32[Tensor, "r 3"]
    target: Float32[Tensor, "r 3"]
    read: Float32[Tensor, "r"] | None  # depth along the ray, where a sensor reads one


class Training:
    """The optimisation of one level, a step at a time."""

    def __init__(
        self,
        scene: Scene,
        field: Field,
        layer: Layer,
        level: int,
        settings: IndustnerfSettings,
        generator: torch.Generator,
        silhouettes: Silhouettes | None = None,
        photo_hull: PhotoHull | None = None,
    ) -> None:
        self.field, self.spacing, self.ways = field, layer.spacing, settings
        self._scene, self.level, self._generator = scene, level, generator
        self.taken = 0
        points = layer.points
        hull = silhouettes.distance(points) / self._unit if settings.relief.use else None
        self._index(points)
        self._showing = points if hull is None else points[hull < OUTLINE]
        layer = layer.only(self.points.order)
        self._trust = layer.trust
        self.relief = None if hull is None else self._relief(hull[self.points.order], photo_hull)
        raw, rgb = layer.residuals or (None, None)
        raw = self.relief.within(raw) if self.relief else raw
        self.field.place(layer.points, raw, rgb, layer.trust, spacing=layer.spacing)
        self._harden()
        self._adam = FieldAdam(field)

    @property
    def steps(self) -> int:
        """How many this level takes."""
        return level_of(self.ways, self.level).steps

    @property
    def image_px(self) -> int:
        """The longer side of the images that this level looks at."""
        return level_of(self.ways, self.level).image_px

    def _index(self, points: Float32[Tensor, "m 3"]) -> None:
        """Sort the points into cells, for two renderers that look at them; none is known empty."""
        ways = self.ways
        reach, side = ways.radius * self.spacing, 1 + self.spacing
        self.points = Points(points, reach, ways.neighbours, ways.readings.weights)
        box = (-side,) * 3, (side,) * 3
        self.renderer = Renderer(self.points, *box, ways.step * self.spacing, ways.stop)
        self._fine = Renderer(self.points, *box, ways.fine_step * self.spacing, ways.stop)
        # which points had a density when it was last looked for
        self.filled = torch.ones(len(points), dtype=torch.bool, device=points.device)

    @cached_property
    def pixels(self) -> Pixels:
        """The images, at the resolution that is learned from; found when first asked for."""
        return Pixels(self._scene, self._seen(self._showing))

    def _seen(self, points: Float32[Tensor, "m 3"]) -> Bool[Tensor, "v h w"]:
        """The pixels of judging views that can show any of the points."""
        seen = footprint(points, self.points.reach, self._scene.eyes, self.image_px)
        judged, judging = torch.zeros_like(seen), view_roles(self.ways.readings.signal).judging
        judged[judging] = seen[judging]
        if not judged.any():
            raise ReconstructionFailed(
                f"no source view can show a point of {name_of(self.level)}: are there views "
                "enough, and do their cameras agree on where the part is?"
            )
        return judged

    def _relief(self, hull: Float32[Tensor, "m"], photo_hull: PhotoHull | None) -> Relief:
        points = self.points.positions
        beside, ways = beside_on_grid(points, self.spacing), self.ways.relief
        if photo_hull is None:
            return Relief(hull, beside, ways)
        start = photo_hull.distance(points) / self._unit
        return Relief(hull, beside, ways, start, photo_hull.believed)

    @property
    def _unit(self) -> float:
        """That raw values are counted in: the first level's spacing."""
        return spacing_of(self.ways.grid_res, 0)

    def _harden(self) -> None:
        """Bring the softness of the surface to where it is after the steps taken."""
        if self.ways.readings.activation == "distance":
            self.field.softness = self.softness()
            self.renderer.beta = self.field.softness * self._unit

    def finely(self, softness: float) -> Renderer:
        """What looks at the field once it is learned, with a surface so soft, in first spacings.

        As the last step had it for colours, which is what was learned: seen aslant, a soft surface
        is nearer than a hard one.  The median is that of `softness.shown`, whatever the colours'.
        """
        if self.ways.readings.activation == "distance":
            self._fine.beta = softness * self._unit
            self._fine.median_beta = self.ways.softness.shown * self._unit
        return self._fine

    def softness(self) -> float:
        """Of the surface after the steps taken, in first spacings."""
        return softness(self.ways, self._share())

    def _share(self) -> float:
        return progress(self.ways, self.level, self.taken)

    def _sweep(self) -> None:
        """Skip space that is empty; points that have nothing near them leave the set.

        No pixel changes by it: a point is left out only where it and all points that are ever
        weighed together with it have no density.  Raises ReconstructionFailed if none has any:
        from there no gradient leads back.
        """
        sigma = self.density()
        self._refuse_empty(sigma)
        if self.field.network is not None:
            needed = near_any(self.points.positions, sigma > 0, 2 * self.points.reach)
            if needed.float().mean() < CROWD:
                sigma = sigma[self._keep(needed)]
        self._fill(sigma > 0)

    def _refuse_empty(self, sigma: Float32[Tensor, "m"]) -> None:
        if not (sigma > 0).any():
            raise ReconstructionFailed(
                f"the field is empty after {self.taken} steps of {name_of(self.level)}: do the "
                "images show anything but background?"
            )

    def _fill(self, filled: Bool[Tensor, "m"]) -> None:
        self.filled = filled
        self.points.fill(filled)

    def _keep(self, needed: Bool[Tensor, "m"]) -> Int64[Tensor, "k"]:
        """Take the other points out of the set; the optimiser goes on with these where it was.

        Returns which they are, in their new order: fewer points have other cells to sort by.
        """
        left = self.points.positions[needed]
        self._index(left)
        self.pixels = self.pixels.showing(self._seen(left))
        self._harden()
        kept = needed.nonzero()[:, 0][self.points.order]
        self._trust = None if self._trust is None else self._trust[:, kept]
        self._adam.keep(kept)
        return kept

    def step(self) -> Float32[Tensor, ""]:
        """One step of Adam; returns the mean squared error of the pixels it looked at.

        Who reads that number waits for the device, which may otherwise be some steps behind.
        """
        self._adam.set_rates(self._share(), self._pace() if self.relief else None)
        self._harden()
        if self._encodes():
            self.field.sources.refresh(self._some_views(), self._generator)
        glance = self.glance(*self.field())
        seen = glance.seen
        loss = error(seen, glance.background, glance.target)
        self._adam.zero_grad()
        taste = preference(seen, self.ways.emptiness, self.ways.veil)
        (loss + taste + off_depth(seen, glance.read, self.ways.depth)).backward()
        self._adam.step()
        self.field.settle()
        if self.relief:
            self.relief.fall_back(self.field.raw, self._pace())
            self.relief.settle(self.field.raw, self.taken + 1, self.steps)
        self.taken += 1
        if self._all_told:
            self._sweep()
            self.field.encode_anew()
        return loss.detach()

    def glance(self, values: Float32[Tensor, "m"], rgb: Float32[Tensor, "m 3"]) -> Glance:
        """Look along the rays of `rays` random pixels at points that hold these."""
        drawn, offsets = self.pixels.draw(self.ways.rays, self._generator)
        rays, target, background = self.pixels.rays(drawn, offsets)
        seen = self.renderer.look(rays, values, rgb)
        target = noisier(target, self.ways.noise, self._generator)
        return Glance(seen, background, target, self.pixels.distances(drawn, rays))

    def _pace(self) -> float:
        """Of distances, in this step."""
        return self.relief.rate(self.softness())

    def _encodes(self) -> bool:
        sources = self.field.sources
        return bool(sources and sources.learns and self.taken % self.ways.network.every == 0)

    def _some_views(self) -> Tensor:
        sources = len(self.field.sources)
        return torch.randperm(sources, generator=self._generator)[: self.ways.network.views]

    @torch.no_grad()
    def values(self) -> tuple[Tensor, Tensor]:
        """What the renderer is given of the points, as they are now: densities or distances."""
        return self.field()

    @torch.no_grad()
    def density(self) -> Tensor:
        """Of the points, as they are now."""
        return density(self.field()[0], self.renderer.beta)

    def testimony(self) -> Testimony:
        """What the source views say of the points: the last level's finely, others' as trained.

        Raises ReconstructionFailed if no point has a density.
        """
        self._harden()  # as soft as after the last step, whether it was taken just now or not
        last = self.level == len(self.ways.levels) - 1
        renderer = self.finely(self.ways.softness.shown) if last else self.renderer
        longest = self.ways.surface_px if last else self.image_px // 2
        values, rgb = self.values()
        sigma = density(values, renderer.beta)
        self._refuse_empty(sigma)
        self._fill(sigma > 0)
        reach, eyes = self.points.reach, self._scene.eyes
        shown = footprint(self.points.positions[sigma > 0], reach, eyes, longest)
        pixels = Pixels(self._scene, shown)
        return testimony(self._scene, pixels, renderer, values, rgb, self.ways.readings)

    @property
    def can_stop(self) -> bool:
        """Whether `state` is all that a later step depends on.

        While E learns it is only just after all views were told by E as it is: `restore` has them
        told so, and between two such looks some are told by an E of some steps ago.
        """
        sources = self.field.sources
        return not (sources and sources.learns) or self._all_told

    @property
    def _all_told(self) -> bool:
        """Whether the last step ended with a look at all points and all views."""
        return self.taken % SWEEP == 0 or self.taken == self.steps

    def state(self) -> dict[str, Any]:
        """All that a later step depends on, but what E made of the views: see `can_stop`."""
        return {
            "taken": self.taken,
            "points": self.points.positions,
            "spacing": self.spacing,
            "trust": self._trust,
            "filled": self.filled,
            "field": self.field.state_dict(),
            "adam": self._adam.state_dict(),
        }

    def restore(self, state: dict[str, Any]) -> None:
        """Go on from `state`, which was taken of the same points.

        What the source views say is not in it, but encoded anew, every view by E as it is now.
        """
        self.taken = state["taken"]
        self.field.load_state_dict(state["field"])
        if self.field.sources:
            self.field.sources.encode_anew()
        self._adam.load_state_dict(state["adam"])
        self._fill(state["filled"].to(self.points.positions.device))
        self._harden()
