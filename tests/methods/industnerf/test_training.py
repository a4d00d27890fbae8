"""A level's training: it learns, forgets only what cannot be seen, and can be taken up again."""

import copy
from typing import Any

import pytest
import torch

from industnerf.errors import ReconstructionFailed
from industnerf.methods.industnerf import training as module
from industnerf.methods.industnerf.carving import Silhouettes
from industnerf.methods.industnerf.field import Field
from industnerf.methods.industnerf.levels import WARM_UP, Layer, grid, spacing_of
from industnerf.methods.industnerf.optimiser import DECAY
from industnerf.methods.industnerf.photohull import PhotoHull
from industnerf.methods.industnerf.run import run
from industnerf.methods.industnerf.training import Training
from industnerf.schema import IndustnerfSettings, SoftnessSettings
from tests.methods.industnerf.scenes import (
    BOTH,
    CPU,
    FREE,
    ball,
    posed,
    scene,
    settings,
    silhouettes_of,
)

RES = 12
PLAIN = {"readings": {"encoder": "none", "pose": "identity", "frame": "world"}}
KINDS = {
    "free": FREE,
    "blind": {"readings": {"encoder": "none"}},
    "frozen": {"readings": {"encoder": "frozen"}},
    "trained": {},
    "both": BOTH,
}
every_kind = pytest.mark.parametrize("kind", KINDS)


def settings_of(kind: str, **changes: Any) -> IndustnerfSettings:
    return settings("industnerf", grid_res=RES, **KINDS[kind] | changes)


def a_training(
    ways: IndustnerfSettings, seed: int = 0, points: torch.Tensor | None = None, level: int = 0
) -> Training:
    """Of a ball in four views, from a grid that is a little shaken: no two cells are alike."""
    torch.manual_seed(seed)
    seen = scene(ball(18.0), 4, 32)
    field = Field(seen, ways)
    places = grid(spacing_of(RES, 0), CPU)
    shaken = places + 0.03 * torch.randn(places.shape, generator=torch.Generator().manual_seed(9))
    generator = torch.Generator().manual_seed(seed)
    layer = Layer(shaken if points is None else points, spacing_of(RES, 0))
    return Training(seen, field, layer, level, ways, generator)


def pixels_of(training: Training, rays: tuple) -> torch.Tensor:
    sigma, rgb = training.values()
    return training.renderer.look(rays[0], sigma, rgb).over(rays[2])


def some_rays(training: Training, count: int) -> tuple:
    pixels = training.pixels
    return pixels.rays(*pixels.draw(count, torch.Generator().manual_seed(5)))


class Inside(torch.nn.Module):
    """Stands in for N, told of positions alone: a ball off the middle, waves of colour."""

    def __init__(self) -> None:
        super().__init__()
        self.brightness = torch.nn.Parameter(torch.ones(1))
        self.straight = torch.nn.Linear(1, 4, bias=False)  # that nothing goes

    def deep_parameters(self) -> list[torch.nn.Parameter]:
        return [self.brightness]

    def forward(self, x: torch.Tensor, colours: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Everything else has no density at all."""
        near = (x - torch.tensor([0.4, 0.2, -0.3])).norm(dim=1) < 0.8
        return (3 * x[:, 0]).where(near, -8.0), self.brightness * (0.5 + 0.5 * (4 * x).sin())


@every_kind
def test_twenty_steps_lower_the_loss(kind):
    training = a_training(settings_of(kind, rays=512, levels=[{"steps": 20}]))
    losses = [training.step() for _ in range(20)]
    # a batch's loss scatters by a tenth; the field starts as a grey fog before white
    assert sum(losses[-5:]) < 0.95 * sum(losses[:5])


@every_kind
def test_same_seed_same_bytes_other_seed_other_bytes(kind):
    def after(seed: int) -> tuple[list[float], bytes]:
        training = a_training(settings_of(kind), seed)
        losses = [training.step() for _ in range(3)]
        return losses, b"".join(values.numpy().tobytes() for values in training.values())

    assert after(1) == after(1)
    assert after(1) != after(2)


def test_rates_fall_from_the_first_step_to_the_last():
    ways = settings_of("both", levels=[{"steps": 4}])
    training = a_training(ways)
    first = [ways.network.rate, ways.network.straight_rate, ways.network.encoder_rate]
    first += [ways.residual.density_rate, ways.residual.colour_rate]
    for taken in range(4):
        training.step()
        rates = [group["lr"] for group in training._adam.param_groups]
        assert rates == pytest.approx([rate * DECAY ** (taken / 4) for rate in first])


def test_over_all_levels_the_surface_hardens_and_rates_fall_once():
    """Geometrically, from the warm-up's first step to the last level's last."""
    softness = SoftnessSettings(4.0, 0.25, 0.1)
    ways = settings_of(
        "trained",
        readings={"activation": "distance"},
        levels=[{"steps": 4}, {"steps": 4}],
        warm_up={"steps": 8},
        softness=softness,
    )
    unit = spacing_of(RES, 0)
    for level, before in ((WARM_UP, 0), (0, 8), (1, 12)):
        training = a_training(ways, level=level)
        for taken in range(training.steps):
            training.step()
            beta = 4.0 * 2.0 ** (-(before + taken) / 4)
            assert training.renderer.beta == pytest.approx(beta * unit)
            assert training.field.softness == pytest.approx(beta)
            rate = training._adam.param_groups[0]["lr"]
            assert rate == pytest.approx(ways.network.rate * DECAY ** ((before + taken) / 16))
    assert training.finely(softness.shown).beta == pytest.approx(0.1 * unit)


def test_hardening_makes_what_n_calls_matter_more_opaque():
    """N counts distances in softnesses: where it says 1 / 2, there is ever more matter."""
    training = a_training(settings_of("trained", readings={"activation": "distance"}))
    with torch.no_grad():
        training.field.network.head.bias[0] = 0.5  # outside by half a softness: thin, and seen
    training.taken = 1
    training._harden()
    soft = training.density()
    training.taken = training.steps
    training._harden()
    assert (training.density() > 2 * soft).all()


def test_what_is_left_out_is_not_trained_on():
    kept = a_training(settings_of("free", readings={"signal": "left_out"}))
    all_views = a_training(settings_of("free"))
    assert set(all_views.pixels.shown[:, 0].tolist()) == {0, 1, 2, 3}
    assert set(kept.pixels.shown[:, 0].tolist()) == {1, 3}


def test_points_start_where_they_are_told_to():
    ways = settings_of("free")
    training = a_training(ways)
    places = training.points.positions.flip(0)
    raw, rgb = places[:, 0] * 2, places / 2 + 0.5
    layer = Layer(places, 0.1, (raw, rgb))
    again = Training(scene(ball(18.0), 4, 32), training.field, layer, 0, ways, torch.Generator())
    positions = again.points.positions
    assert not torch.equal(positions, places)  # sorted
    assert torch.equal(again.field.raw, positions[:, 0] * 2)
    assert torch.equal(again.field.rgb, positions / 2 + 0.5)


# --- sweeping ---------------------------------------------------------------------------------


@pytest.mark.parametrize(("weights", "left"), [("inverse_square", 0.5), ("tent", 0.65)])
def test_a_sweep_changes_no_pixel(weights, left):
    readings = PLAIN["readings"] | {"weights": weights}
    training = a_training(settings("industnerf", grid_res=RES, **(PLAIN | {"readings": readings})))
    training.field.network = Inside()
    rays = some_rays(training, 2000)
    before, count = pixels_of(training, rays), len(training.points)
    assert (before - rays[2]).abs().max() > 0.5
    training._adam.param_groups[0]["params"] = list(training.field.network.parameters())
    training._sweep()
    assert len(training.points) < left * count
    # neighbours of another order are summed in float32
    torch.testing.assert_close(pixels_of(training, rays), before, rtol=0, atol=1e-5)


def test_sweeping_free_points_skips_space_and_forgets_none():
    training = a_training(settings_of("free", initial=1.0))
    with torch.no_grad():
        training.field.raw[training.points.positions[:, 0] > -0.2] = -8.0
    rays = some_rays(training, 2000)
    before, count = pixels_of(training, rays), len(training.points)
    training._sweep()
    assert len(training.points) == count
    assert torch.equal(pixels_of(training, rays), before)
    training.points.fill(torch.zeros(count, dtype=torch.bool))  # the test can tell
    assert not torch.equal(pixels_of(training, rays), before)


def test_what_points_learned_and_their_moments_follow_them():
    training = a_training(settings_of("both", initial=1.0))
    for _ in range(3):
        training.step()
    field, adam = training.field, training._adam
    with torch.no_grad():
        field.raw[training.points.positions[:, 0] > -0.2] = -20.0

    def rows() -> torch.Tensor:
        """All that belongs to a point, sorted by where it is."""
        own = [field.raw[:, None], field.rgb]
        for p in field.own():
            own += [adam.state[p][name].reshape(len(p), -1) for name in ("exp_avg", "exp_avg_sq")]
        table = torch.cat([training.points.positions, *own], dim=1).detach()
        return table[torch.argsort(table[:, 0])]

    before, count = rows(), len(training.points)
    assert len(before[:, 0].unique()) == count  # x alone tells points apart
    training._sweep()
    after = rows()
    assert len(after) < 0.8 * count
    expected = before[torch.isin(before[:, 0], after[:, 0])]
    assert torch.equal(after, expected)
    steps = [adam.state[p]["step"].item() for p in field.own()]
    assert steps == [3, 3]
    # what the optimiser moves is what the field is made of
    moved = [p.detach().clone() for p in field.own()]
    training.step()
    assert all((p != q).any() for p, q in zip(field.own(), moved, strict=True))
    assert {id(p) for group in adam.param_groups for p in group["params"]} == {
        id(p) for group in field.groups() for p in group["params"]
    }


def test_steps_sweep_now_and_then(monkeypatch):
    monkeypatch.setattr(module, "SWEEP", 3)
    training = a_training(settings("industnerf", grid_res=RES, **PLAIN))
    network = Inside()
    training.field.network = network
    training._adam.param_groups[0]["params"] = list(network.parameters())
    sizes = []
    for _ in range(4):
        training.step()
        sizes.append(len(training.points))
    assert sizes[0] == sizes[1] > sizes[2] == sizes[3]
    assert network.brightness.item() != 1  # it went on learning


# --- interrupted, and taken up again ------------------------------------------------------------


def resumed(ways: IndustnerfSettings, halfway: int, steps: int) -> tuple[Training, Training]:
    """The same training in one go, and from the state it had `halfway`, in a new process."""
    whole = a_training(ways)
    for _ in range(halfway):
        whole.step()
    state = copy.deepcopy(whole.state())
    noise = whole._generator.get_state()
    other = a_training(ways, seed=77, points=state["points"])  # what is random is in the state
    other.restore(state)
    other._generator.set_state(noise)
    for _ in range(halfway, steps):
        whole.step()
        other.step()
    return whole, other


@pytest.mark.parametrize("kind", ["free", "blind", "frozen"])
@pytest.mark.parametrize("halfway", [2, 5])  # before and after the first sweep
def test_a_training_that_is_taken_up_again_is_the_same(kind, halfway, monkeypatch):
    monkeypatch.setattr(module, "SWEEP", 4)
    whole, other = resumed(settings_of(kind, initial=-5.9), halfway, 9)
    assert other.taken == whole.taken == 9
    assert torch.equal(whole.points.positions, other.points.positions)
    for a, b in zip(whole.values(), other.values(), strict=True):
        assert torch.equal(a, b)


def test_with_a_trained_encoder_that_sees_all_views_only_rounding_differs(monkeypatch):
    """Features of all views together or one by one; ten steps of Adam make more of it."""
    monkeypatch.setattr(module, "SWEEP", 4)
    whole, other = resumed(settings_of("trained", network={"every": 1, "views": 4}), 5, 9)
    for a, b in zip(whole.values(), other.values(), strict=True):
        torch.testing.assert_close(a, b, rtol=1e-3, atol=1e-3)


def test_with_a_trained_encoder_no_view_is_staler_than_it_was():
    """Taken up again, every view is told by E as it is, where one of four was due: the loss is
    no worse for it, but for the scatter of a batch of 256 rays."""
    ways = settings_of("trained", network={"every": 2, "views": 1}, levels=[{"steps": 40}])
    whole, other = resumed(ways, 10, 40)
    last = [sum(t.step() for _ in range(5)) for t in (whole, other)]
    assert last[1] < 1.3 * last[0]


def test_points_that_were_skipped_stay_skipped():
    """Between sweeps points may become dense again where rays do not look; that is in the state."""
    ways = settings_of("free", initial=1.0)
    whole = a_training(ways)
    empty = whole.points.positions[:, 0] > 0
    with torch.no_grad():
        whole.field.raw[empty] = -8.0
    whole._sweep()
    with torch.no_grad():
        whole.field.raw[empty] = 1.0
    other = a_training(ways, points=whole.points.positions)
    other.restore(copy.deepcopy(whole.state()))
    rays = some_rays(whole, 500)
    assert torch.equal(pixels_of(whole, rays), pixels_of(other, rays))


def test_the_state_is_what_a_checkpoint_takes():
    """Tensors, numbers and texts; torch reads it back without running any code."""
    training = a_training(settings_of("both"))
    training.step()

    def plain(value: Any) -> bool:
        if isinstance(value, dict):
            return all(plain(v) for v in value.values())
        if isinstance(value, list | tuple):
            return all(map(plain, value))
        return isinstance(value, torch.Tensor | int | float | str | bool | None)

    assert plain(training.state())


# --- what the views say -----------------------------------------------------------------------


def test_testimony_speaks_of_the_points_as_they_are():
    training = a_training(settings_of("free", initial=2.0))
    told = training.testimony()
    assert told.confidence.shape == told.view.shape == training.values()[0].shape
    with torch.no_grad():
        training.field.raw.fill_(-8.0)
    with pytest.raises(ReconstructionFailed, match="the field is empty after 0 steps of level 0"):
        training.testimony()


def test_a_single_view_that_is_left_out_is_said_to_be_too_few():
    """It would judge nothing and speak alone; before, drawing from no pixels failed in torch."""
    ways = settings(readings={"signal": "left_out"})
    with pytest.raises(ReconstructionFailed, match="are there views enough"):
        run(posed(ball(18.0), 1, 32), ways, 0)


def a_relief(raw: torch.Tensor) -> tuple[Training, Silhouettes]:
    """A ball's, that starts from these distances at the points of the first grid."""
    seen, ways = scene(ball(18.0), 6, 48), settings("industnerf_plus", grid_res=RES)
    silhouettes = silhouettes_of(seen)
    start = raw, torch.full((len(raw), 3), 0.5)
    layer = Layer(grid(spacing_of(RES, 0), CPU), spacing_of(RES, 0), residuals=start)
    field = Field(seen, ways)
    return Training(seen, field, layer, 0, ways, torch.Generator(), silhouettes), silhouettes


def test_a_relief_goes_on_from_the_last_levels_distances_and_nowhere_deeper_than_the_hull():
    last = torch.linspace(-3, 3, len(grid(spacing_of(RES, 0), CPU)))
    training, silhouettes = a_relief(last)
    hull = silhouettes.distance(training.points.positions) / spacing_of(RES, 0)
    expected = torch.maximum(last[training.points.order], hull)
    assert torch.equal(training.field.raw.detach(), expected)


def test_a_relief_starts_at_the_photo_hull_where_that_is_deeper_inside_than_the_hull():
    class Inner(PhotoHull):
        def __init__(self) -> None:
            """Made of no photographs."""
            self.believed = True

        def distance(self, points: torch.Tensor) -> torch.Tensor:
            return torch.full((len(points),), 2 * spacing_of(RES, 0))

    seen, ways = scene(ball(18.0), 6, 48), settings("industnerf_plus", grid_res=RES)
    silhouettes = silhouettes_of(seen)
    layer = Layer(grid(spacing_of(RES, 0), CPU), spacing_of(RES, 0))
    training = Training(
        seen, Field(seen, ways), layer, 0, ways, torch.Generator(), silhouettes, Inner()
    )
    hull = silhouettes.distance(training.points.positions) / spacing_of(RES, 0)
    assert (hull < 2).any()
    torch.testing.assert_close(training.field.raw.detach(), hull.clamp(min=2.0))


def test_what_views_say_of_a_hard_surface_needs_no_space_where_only_a_soft_one_has_density(
    monkeypatch,
):
    training, _ = a_relief(torch.full((len(grid(spacing_of(RES, 0), CPU)),), -9.0))
    assert training.ways.softness.shown < training.softness()
    filled = []
    monkeypatch.setattr(training, "_fill", lambda which: filled.append(int(which.sum())))
    everywhere = training.testimony()  # rays skip nothing yet
    monkeypatch.undo()
    skipping = training.testimony()
    assert 0 < filled[0] < int((training.density() > 0).sum())
    assert torch.equal(skipping.of_views, everywhere.of_views)
    for name, value in vars(skipping.surface).items():
        assert torch.equal(value, getattr(everywhere.surface, name)), name
