"""Learning the field of one level: re-rendering the source views is the only signal, R10."""

from typing import Any

import torch
from jaxtyping import Bool, Float32, Int64
from torch import Tensor

from industnerf.errors import ReconstructionFailed
from industnerf.methods.industnerf.carving import Silhouettes
from industnerf.methods.industnerf.field import Field
from industnerf.methods.industnerf.levels import near_any, spacing_of
from industnerf.methods.industnerf.pixels import Pixels, footprint
from industnerf.methods.industnerf.relief import Relief, beside_on_grid
from industnerf.methods.industnerf.scene import Scene
from industnerf.methods.industnerf.witnesses import Testimony, testimony
from industnerf.rendering.distance import density
from industnerf.rendering.points import Points
from industnerf.rendering.render import Renderer, Seen
from industnerf.schema import IndustnerfSettings

DECAY = 0.1  # of every learning rate from a level's first step to its last
SWEEP = 25  # steps from one look for empty points to the next
OUTLINE = 1.0  # spacings beyond the hull: no pixel that is farther can tell anything new
CROWD = 0.9  # of the points; if more are needed, sorting out the rest is not worth it


class Training:
    """The optimisation of one level, a step at a time."""

    def __init__(
        self,
        scene: Scene,
        field: Field,
        points: Float32[Tensor, "m 3"],
        spacing: float,
        level: int,
        settings: IndustnerfSettings,
        generator: torch.Generator,
        start: tuple[Tensor, Tensor] | None,
        silhouettes: Silhouettes | None = None,
    ) -> None:
        self.field, self.spacing, self.ways = field, spacing, settings
        self._scene, self.level, self._generator = scene, level, generator
        self.taken = 0
        hull = silhouettes.distance(points) / self._unit if settings.relief.use else None
        self._index(points, points if hull is None else points[hull < OUTLINE])
        start = tuple(x[self.points.order] for x in start) if start else ()
        self.relief = None if hull is None else self._relief(hull[self.points.order])
        if self.relief and not start:
            start = (self.relief.hull,)
        self.field.place(self.points.positions, *start)
        self._harden()
        self._adam = torch.optim.Adam(field.groups(), betas=(0.9, 0.99), eps=1e-8)
        self._rates = [group["lr"] for group in self._adam.param_groups]

    @property
    def steps(self) -> int:
        """How many this level takes."""
        return self.ways.levels[self.level].steps

    @property
    def image_px(self) -> int:
        """The longer side of the images that this level looks at."""
        return self.ways.levels[self.level].image_px

    def _index(self, points: Float32[Tensor, "m 3"], shown: Float32[Tensor, "n 3"]) -> None:
        """Sort the points and find the pixels that can show those of them that are `shown`."""
        ways = self.ways
        reach, side = ways.radius * self.spacing, 1 + self.spacing
        self.points = Points(points, reach, ways.neighbours, ways.readings.weights)
        box = (-side,) * 3, (side,) * 3
        self.renderer = Renderer(self.points, *box, ways.step * self.spacing, ways.stop)
        self.fine = Renderer(self.points, *box, ways.fine_step * self.spacing, ways.stop)
        self._filled = torch.ones(len(points), dtype=torch.bool, device=points.device)
        seen = footprint(shown, self.points.reach, self._scene.eyes, self.image_px)
        if ways.readings.signal == "left_out":
            seen[::2] = False  # these speak of the points, the others judge
        if not seen.any():
            raise ReconstructionFailed(
                f"no source view can show a point of level {self.level}: are there views enough, "
                "and do their cameras agree on where the part is?"
            )
        self.pixels = Pixels(self._scene, self.image_px, seen)

    def _relief(self, hull: Float32[Tensor, "m"]) -> Relief:
        beside = beside_on_grid(self.points.positions, self.spacing)
        return Relief(hull, beside, self.ways.relief)

    @property
    def _unit(self) -> float:
        """That raw values are counted in: the first level's spacing."""
        return spacing_of(self.ways.grid_res, 0)

    def _harden(self) -> None:
        """Bring the softness of the surface to where it is after the steps taken."""
        if self.relief:
            self.renderer.beta = self.relief.beta(self.taken / self.steps) * self._unit
            self.fine.beta = self.ways.relief.shown * self._unit

    def _sweep(self) -> None:
        """Skip space that is empty; points that have nothing near them leave the set.

        No pixel changes by it: a point is left out only where it and all points that are ever
        weighed together with it have no density.  Raises ReconstructionFailed if none has any:
        from there no gradient leads back.
        """
        sigma = self.density()
        if not (sigma > 0).any():
            raise ReconstructionFailed(
                f"the field is empty after {self.taken} steps of level {self.level}: do the images "
                "show anything but background?"
            )
        if self.field.network is not None:
            needed = near_any(self.points.positions, sigma > 0, 2 * self.points.radius)
            if needed.float().mean() < CROWD:
                sigma = sigma[self._keep(needed)]
        self._fill(sigma > 0)

    def _fill(self, filled: Bool[Tensor, "m"]) -> None:
        self._filled = filled
        self.points.fill(filled)

    def _keep(self, needed: Bool[Tensor, "m"]) -> Int64[Tensor, "k"]:
        """Take the other points out of the set; the optimiser goes on with these where it was.

        Returns which they are, in their new order: fewer points have other cells to sort by.
        """
        left = self.points.positions[needed]
        self._index(left, left)
        kept = needed.nonzero()[:, 0][self.points.order]
        before = self.field.own()
        self.field.keep(kept)
        for old, new in zip(before, self.field.own(), strict=True):
            moments = self._adam.state.pop(old)
            self._adam.state[new] = {
                name: value[kept] if value.shape == old.shape else value
                for name, value in moments.items()
            }
        learned = self.field.groups()
        for group, named in zip(self._adam.param_groups, learned, strict=True):
            group["params"] = named["params"]
        return kept

    def step(self) -> float:
        """One step of Adam; returns the mean squared error of the pixels it looked at."""
        self._set_rates()
        self._harden()
        if self._encodes():
            self.field.sources.refresh(self._some_views())
        rays, target, background = self.pixels.draw(self.ways.rays, self._generator)
        seen = self.renderer.look(rays, *self.field())
        loss = ((seen.over(background) - target) ** 2).mean()
        self._adam.zero_grad()
        (loss + self._preference(seen)).backward()
        self._adam.step()
        self.field.settle()
        self.taken += 1
        if self.relief:
            self.relief.settle(self.field.raw, self.taken, self.steps)
        if self.taken % SWEEP == 0:
            self._sweep()
        return loss.item()

    def _set_rates(self) -> None:
        share = self.taken / self.steps
        for group, rate in zip(self._adam.param_groups, self._rates, strict=True):
            group["lr"] = rate * DECAY**share
            if self.relief and group["params"][0] is self.field.raw:
                group["lr"] = self.relief.rate(self.taken, share)

    def _preference(self, seen: Seen) -> Float32[Tensor, ""]:
        """Of fields that re-render alike, rather the emptier one and the one that is less spread.

        Without it, matter of the background's colour anywhere outside the part is as good as none.
        """
        matter = self.ways.emptiness * (1 - seen.through).mean()
        return matter + self.ways.spread * seen.spread.mean() / self.spacing

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
        """What the source views say of the points."""
        values, rgb = self.values()
        sigma = self.density()
        self._fill(sigma > 0)
        reach, eyes = self.points.reach, self._scene.eyes
        longest = self.ways.surface_px
        shown = footprint(self.points.positions[sigma > 0], reach, eyes, longest)
        pixels = Pixels(self._scene, longest, shown)
        return testimony(self._scene, pixels, self.fine, values, rgb, self.ways.readings)

    def state(self) -> dict[str, Any]:
        """All that a later step depends on."""
        return {
            "taken": self.taken,
            "points": self.points.positions,
            "filled": self._filled,
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
            self.field.sources.place(self.points.positions)
        self._adam.load_state_dict(state["adam"])
        self._fill(state["filled"])
        self._harden()
