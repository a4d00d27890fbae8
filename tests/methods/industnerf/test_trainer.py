"""A level's training: it learns, forgets only what cannot be seen, and can be taken up again."""

import copy
from typing import Any

import pytest
import torch

from industnerf.errors import ReconstructionFailed
from industnerf.methods.industnerf import trainer as module
from industnerf.methods.industnerf.field import Field
from industnerf.methods.industnerf.optimizer import LR_DECAY
from industnerf.methods.industnerf.point_levels import (
    WARM_UP,
    PointLevel,
    grid_spacing,
    initial_grid,
)
from industnerf.methods.industnerf.trainer import Trainer
from industnerf.schema import BetaSchedule, IndustnerfSettings
from tests.methods.industnerf.results import run
from tests.methods.industnerf.synthetic_scenes import (
    CPU,
    FREE_POINTS,
    WITH_RESIDUAL,
    ball,
    make_posed_images,
    make_test_scene,
    settings,
)

RES = 12
PLAIN = {
    "readings": {"encoder": "none", "position_encoding": "identity", "encoding_frame": "world"}
}
KINDS = {
    "free": FREE_POINTS,
    "blind": {"readings": {"encoder": "none"}},
    "frozen": {"readings": {"encoder": "frozen"}},
    "trained": {},
    "both": WITH_RESIDUAL,
}
every_kind = pytest.mark.parametrize("kind", KINDS)


def settings_of(kind: str, **changes: Any) -> IndustnerfSettings:
    return settings("industnerf", grid_res=RES, **KINDS[kind] | changes)


def make_trainer(
    config: IndustnerfSettings, seed: int = 0, points: torch.Tensor | None = None, level: int = 0
) -> Trainer:
    """Of a ball in four views, from a grid that is a little shaken: no two cells are alike."""
    torch.manual_seed(seed)
    views = make_test_scene(ball(18.0), 4, 32)
    field = Field(views, config)
    positions = initial_grid(grid_spacing(RES, 0), CPU)
    jittered = positions + 0.03 * torch.randn(
        positions.shape, generator=torch.Generator().manual_seed(9)
    )
    generator = torch.Generator().manual_seed(seed)
    level_points = PointLevel(jittered if points is None else points, grid_spacing(RES, 0))
    return Trainer(views, field, level_points, level, config, generator)


def render_pixels(trainer: Trainer, rays: tuple) -> torch.Tensor:
    sigma, rgb = trainer.values()
    return trainer.renderer.render(rays[0], sigma, rgb).composite_over(rays[2])


def sample_rays(trainer: Trainer, count: int) -> tuple:
    sampler = trainer.ray_sampler
    return sampler.rays(*sampler.sample_pixels(count, torch.Generator().manual_seed(5)))


class AnalyticNetwork(torch.nn.Module):
    """Stands in for N, told of positions alone: a ball off the middle, waves of color."""

    def __init__(self) -> None:
        super().__init__()
        self.brightness = torch.nn.Parameter(torch.ones(1))
        self.skip = torch.nn.Linear(1, 4, bias=False)  # that nothing goes

    def mlp_parameters(self) -> list[torch.nn.Parameter]:
        return [self.brightness]

    def forward(self, x: torch.Tensor, colors: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Everything else has no density at all."""
        is_inside = (x - torch.tensor([0.4, 0.2, -0.3])).norm(dim=1) < 0.8
        return (3 * x[:, 0]).where(is_inside, -8.0), self.brightness * (0.5 + 0.5 * (4 * x).sin())


@every_kind
def test_twenty_steps_lower_the_loss(kind):
    trainer = make_trainer(settings_of(kind, rays_per_step=512, levels=[{"steps": 20}]))
    losses = [trainer.step() for _ in range(20)]
    # a batch's loss scatters by a tenth; the field starts as a gray fog before white
    assert sum(losses[-5:]) < 0.95 * sum(losses[:5])


@every_kind
def test_same_seed_same_bytes_other_seed_other_bytes(kind):
    def after(seed: int) -> tuple[list[float], bytes]:
        trainer = make_trainer(settings_of(kind), seed)
        losses = [trainer.step() for _ in range(3)]
        return losses, b"".join(values.numpy().tobytes() for values in trainer.values())

    assert after(1) == after(1)
    assert after(1) != after(2)


def test_rates_fall_from_the_first_step_to_the_last():
    config = settings_of("both", levels=[{"steps": 4}])
    trainer = make_trainer(config)
    first = [config.network.lr, config.network.skip_lr, config.network.encoder_lr]
    first += [config.residual.density_lr, config.residual.color_lr]
    for step in range(4):
        trainer.step()
        lrs = [group["lr"] for group in trainer._optimizer.param_groups]
        assert lrs == pytest.approx([lr * LR_DECAY ** (step / 4) for lr in first])


def test_over_all_levels_the_surface_hardens_and_rates_fall_once():
    """Geometrically, from the warm-up's first step to the last level's last."""
    beta_schedule = BetaSchedule(4.0, 0.25, 0.1)
    config = settings_of(
        "trained",
        readings={"density_activation": "sdf"},
        levels=[{"steps": 4}, {"steps": 4}],
        warm_up={"steps": 8},
        beta=beta_schedule,
    )
    unit = grid_spacing(RES, 0)
    for level, before in ((WARM_UP, 0), (0, 8), (1, 12)):
        trainer = make_trainer(config, level=level)
        for step in range(trainer.num_steps):
            trainer.step()
            beta = 4.0 * 2.0 ** (-(before + step) / 4)
            assert trainer.renderer.beta == pytest.approx(beta * unit)
            assert trainer.field.beta == pytest.approx(beta)
            lr = trainer._optimizer.param_groups[0]["lr"]
            assert lr == pytest.approx(config.network.lr * LR_DECAY ** ((before + step) / 16))
    assert trainer.fine_renderer(beta_schedule.render).beta == pytest.approx(0.1 * unit)


def test_hardening_makes_what_n_calls_matter_more_opaque():
    """N counts distances in softnesses: where it says 1 / 2, there is ever more matter."""
    trainer = make_trainer(settings_of("trained", readings={"density_activation": "sdf"}))
    with torch.no_grad():
        trainer.field.network.head.bias[0] = 0.5  # outside by half a softness: thin, and seen
    trainer.steps_done = 1
    trainer._update_beta()
    soft = trainer.density()
    trainer.steps_done = trainer.num_steps
    trainer._update_beta()
    assert (trainer.density() > 2 * soft).all()


def test_what_is_left_out_is_not_trained_on():
    disjoint = make_trainer(settings_of("free", readings={"target_views": "disjoint"}))
    all_views = make_trainer(settings_of("free"))
    assert set(all_views.ray_sampler.visible_pixels[:, 0].tolist()) == {0, 1, 2, 3}
    assert set(disjoint.ray_sampler.visible_pixels[:, 0].tolist()) == {1, 3}


def test_points_start_where_they_are_told_to():
    config = settings_of("free")
    trainer = make_trainer(config)
    start_positions = trainer.points.positions.flip(0)
    raw, rgb = start_positions[:, 0] * 2, start_positions / 2 + 0.5
    level_points = PointLevel(start_positions, 0.1, (raw, rgb))
    second_trainer = Trainer(
        make_test_scene(ball(18.0), 4, 32),
        trainer.field,
        level_points,
        0,
        config,
        torch.Generator(),
    )
    positions = second_trainer.points.positions
    assert not torch.equal(positions, start_positions)  # sorted
    assert torch.equal(second_trainer.field.raw, positions[:, 0] * 2)
    assert torch.equal(second_trainer.field.rgb, positions / 2 + 0.5)


# --- sweeping ---------------------------------------------------------------------------------


@pytest.mark.parametrize(("weights", "left"), [("inverse_square", 0.5), ("trilinear", 0.65)])
def test_a_sweep_changes_no_pixel(weights, left):
    readings = PLAIN["readings"] | {"interpolation": weights}
    trainer = make_trainer(settings("industnerf", grid_res=RES, **(PLAIN | {"readings": readings})))
    trainer.field.network = AnalyticNetwork()
    rays = sample_rays(trainer, 2000)
    before, count = render_pixels(trainer, rays), len(trainer.points)
    assert (before - rays[2]).abs().max() > 0.5
    trainer._optimizer.param_groups[0]["params"] = list(trainer.field.network.parameters())
    trainer._prune_empty()
    assert len(trainer.points) < left * count
    # neighbors of another order are summed in float32
    torch.testing.assert_close(render_pixels(trainer, rays), before, rtol=0, atol=1e-5)


def test_sweeping_free_points_skips_space_and_forgets_none():
    trainer = make_trainer(settings_of("free", density_bias=1.0))
    with torch.no_grad():
        trainer.field.raw[trainer.points.positions[:, 0] > -0.2] = -8.0
    rays = sample_rays(trainer, 2000)
    before, count = render_pixels(trainer, rays), len(trainer.points)
    trainer._prune_empty()
    assert len(trainer.points) == count
    assert torch.equal(render_pixels(trainer, rays), before)
    trainer.points.update_occupancy(torch.zeros(count, dtype=torch.bool))  # the test can tell
    assert not torch.equal(render_pixels(trainer, rays), before)


def test_what_points_learned_and_their_moments_follow_them():
    trainer = make_trainer(settings_of("both", density_bias=1.0))
    for _ in range(3):
        trainer.step()
    field, optimizer = trainer.field, trainer._optimizer
    with torch.no_grad():
        field.raw[trainer.points.positions[:, 0] > -0.2] = -20.0

    def rows() -> torch.Tensor:
        """All that belongs to a point, sorted by where it is."""
        columns = [field.raw[:, None], field.rgb]
        for p in field.point_parameters():
            columns += [
                optimizer.state[p][name].reshape(len(p), -1) for name in ("exp_avg", "exp_avg_sq")
            ]
        table = torch.cat([trainer.points.positions, *columns], dim=1).detach()
        return table[torch.argsort(table[:, 0])]

    before, count = rows(), len(trainer.points)
    assert len(before[:, 0].unique()) == count  # x alone tells points apart
    trainer._prune_empty()
    after = rows()
    assert len(after) < 0.8 * count
    expected = before[torch.isin(before[:, 0], after[:, 0])]
    assert torch.equal(after, expected)
    steps = [optimizer.state[p]["step"].item() for p in field.point_parameters()]
    assert steps == [3, 3]
    # what the optimizer moves is what the field is made of
    moved = [p.detach().clone() for p in field.point_parameters()]
    trainer.step()
    assert all((p != q).any() for p, q in zip(field.point_parameters(), moved, strict=True))
    assert {id(p) for group in optimizer.param_groups for p in group["params"]} == {
        id(p) for group in field.param_groups() for p in group["params"]
    }


def test_steps_sweep_now_and_then(monkeypatch):
    monkeypatch.setattr(module, "REFRESH_INTERVAL", 3)
    trainer = make_trainer(settings("industnerf", grid_res=RES, **PLAIN))
    network = AnalyticNetwork()
    trainer.field.network = network
    trainer._optimizer.param_groups[0]["params"] = list(network.parameters())
    sizes = []
    for _ in range(4):
        trainer.step()
        sizes.append(len(trainer.points))
    assert sizes[0] == sizes[1] > sizes[2] == sizes[3]
    assert network.brightness.item() != 1  # it went on learning


# --- interrupted, and taken up again ------------------------------------------------------------


def train_and_resume(
    config: IndustnerfSettings, halfway: int, steps: int
) -> tuple[Trainer, Trainer]:
    """The same training in one go, and from the state it had `halfway`, in a new process."""
    uninterrupted = make_trainer(config)
    for _ in range(halfway):
        uninterrupted.step()
    state = copy.deepcopy(uninterrupted.state())
    generator_state = uninterrupted._generator.get_state()
    restored = make_trainer(
        config, seed=77, points=state["points"]
    )  # what is random is in the state
    restored.restore(state)
    restored._generator.set_state(generator_state)
    for _ in range(halfway, steps):
        uninterrupted.step()
        restored.step()
    return uninterrupted, restored


@pytest.mark.parametrize("kind", ["free", "blind", "frozen"])
@pytest.mark.parametrize("halfway", [2, 5])  # before and after the first sweep
def test_a_training_that_is_taken_up_again_is_the_same(kind, halfway, monkeypatch):
    monkeypatch.setattr(module, "REFRESH_INTERVAL", 4)
    uninterrupted, restored = train_and_resume(settings_of(kind, density_bias=-5.9), halfway, 9)
    assert restored.steps_done == uninterrupted.steps_done == 9
    assert torch.equal(uninterrupted.points.positions, restored.points.positions)
    for a, b in zip(uninterrupted.values(), restored.values(), strict=True):
        assert torch.equal(a, b)


def test_with_a_trained_encoder_that_sees_all_views_only_rounding_differs(monkeypatch):
    """Features of all views together or one by one; ten steps of Adam make more of it."""
    monkeypatch.setattr(module, "REFRESH_INTERVAL", 4)
    uninterrupted, restored = train_and_resume(
        settings_of("trained", network={"encoder_update_interval": 1, "encoder_update_views": 4}),
        5,
        9,
    )
    for a, b in zip(uninterrupted.values(), restored.values(), strict=True):
        torch.testing.assert_close(a, b, rtol=1e-3, atol=1e-3)


def test_with_a_trained_encoder_no_view_is_staler_than_it_was():
    """Taken up again, every view is told by E as it is, where one of four was due: the loss is
    no worse for it, but for the scatter of a batch of 256 rays."""
    config = settings_of(
        "trained",
        network={"encoder_update_interval": 2, "encoder_update_views": 1},
        levels=[{"steps": 40}],
    )
    uninterrupted, restored = train_and_resume(config, 10, 40)
    last = [sum(t.step() for _ in range(5)) for t in (uninterrupted, restored)]
    assert last[1] < 1.3 * last[0]


def make_weighted_trainer(kind: str, level: int = 0, **changes: Any) -> Trainer:
    """Of points of which views are said to be sure at random."""
    trainer = make_trainer(settings_of(kind, **changes), level=level)
    random = torch.rand(4, len(trainer.points), generator=torch.Generator().manual_seed(3))
    trainer._view_weights = random
    trainer.field.set_view_weights(random)
    return trainer


def test_views_are_weighted_by_what_they_see_now_every_so_many_steps():
    trainer = make_weighted_trainer(
        "frozen", density_bias=-2.0, view_weights_interval=2, levels=[{"steps": 4}]
    )
    given, before = trainer._view_weights, trainer.field.source_features()
    trainer.step()
    assert trainer._view_weights is given
    trainer.step()
    weighted = trainer.field.source_features()
    assert (weighted - before).abs().max() > 0.01
    # E is as it was: only the weights are new, and those are what the field before them shows
    trainer.field.set_view_weights(given)
    assert torch.equal(trainer.field.source_features(), before)
    now = trainer._compute_view_confidence(trainer.renderer, trainer.image_px // 2).per_view
    assert torch.equal(trainer._view_weights, now)
    trainer.field.set_view_weights(now)
    assert torch.equal(trainer.field.source_features(), weighted)


@pytest.mark.parametrize("changes", [{"view_weights_interval": 0}, {"levels": [{"steps": 2}]}])
def test_views_keep_their_weights_where_none_are_due(changes):
    trainer = make_weighted_trainer("frozen", **{"view_weights_interval": 2} | changes)
    given = trainer._view_weights
    trainer.step(), trainer.step()
    assert trainer._view_weights is given


def test_without_weights_of_a_level_before_all_views_stay_equal():
    trainer = make_trainer(settings_of("frozen", density_bias=-2.0, view_weights_interval=1))
    trainer.step()
    assert trainer._view_weights is None


@pytest.mark.parametrize("level", [WARM_UP, 0, 1])
def test_the_encoder_is_trained_in_the_first_levels_alone(level):
    config = settings_of(
        "trained",
        network={"encoder_update_levels": 1, "encoder_update_interval": 1},
        levels=[{"steps": 3}, {"steps": 3}],
        warm_up={"steps": 3},
    )
    trainer = make_trainer(config, level=level)
    before = copy.deepcopy(trainer.field.source_features.encoder.state_dict())
    for _ in range(2):
        trainer.step()
    after = trainer.field.source_features.encoder.state_dict()
    is_kept = all(torch.equal(before[name], after[name]) for name in before)
    assert is_kept == (level == 1)
    assert trainer.is_checkpointable == (level == 1)  # all views are as E has them


def test_points_that_were_skipped_stay_skipped():
    """Between sweeps points may become dense again where rays do not look; that is in the state."""
    config = settings_of("free", density_bias=1.0)
    uninterrupted = make_trainer(config)
    empty = uninterrupted.points.positions[:, 0] > 0
    with torch.no_grad():
        uninterrupted.field.raw[empty] = -8.0
    uninterrupted._prune_empty()
    with torch.no_grad():
        uninterrupted.field.raw[empty] = 1.0
    restored = make_trainer(config, points=uninterrupted.points.positions)
    restored.restore(copy.deepcopy(uninterrupted.state()))
    rays = sample_rays(uninterrupted, 500)
    assert torch.equal(render_pixels(uninterrupted, rays), render_pixels(restored, rays))


def test_the_state_is_what_a_checkpoint_takes():
    """Tensors, numbers and texts; torch reads it back without running any code."""
    trainer = make_trainer(settings_of("both"))
    trainer.step()

    def plain(value: Any) -> bool:
        if isinstance(value, dict):
            return all(plain(v) for v in value.values())
        if isinstance(value, list | tuple):
            return all(map(plain, value))
        return isinstance(value, torch.Tensor | int | float | str | bool | None)

    assert plain(trainer.state())


# --- what the views say -----------------------------------------------------------------------


def test_view_confidence_is_of_the_points_as_they_are():
    trainer = make_trainer(settings_of("free", density_bias=2.0))
    view_confidence = trainer.view_confidence()
    assert (
        view_confidence.confidence.shape == view_confidence.view.shape == trainer.values()[0].shape
    )
    with torch.no_grad():
        trainer.field.raw.fill_(-8.0)
    with pytest.raises(ReconstructionFailed, match="the field is empty after 0 steps of level 0"):
        trainer.view_confidence()


def test_a_single_view_that_is_left_out_is_said_to_be_too_few():
    """It would judge nothing and speak alone; before, drawing from no pixels failed in torch."""
    config = settings(readings={"target_views": "disjoint"})
    with pytest.raises(ReconstructionFailed, match="are there views enough"):
        run(make_posed_images(ball(18.0), 1, 32), config, 0)
