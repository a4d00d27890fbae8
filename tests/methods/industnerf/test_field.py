"""The field with points of its own, with a network, and with both."""

import pytest
import torch

from industnerf.methods.industnerf.field import EMPTY_RAW_DENSITY, Field
from industnerf.methods.industnerf.network import COLOR_EPS, activate
from industnerf.methods.industnerf.point_levels import grid_spacing
from industnerf.methods.industnerf.source_features import GRAY
from industnerf.schema import IndustnerfSettings
from tests.methods.industnerf.synthetic_scenes import (
    FREE_POINTS,
    WITH_RESIDUAL,
    ball,
    make_test_scene,
    settings,
)

KINDS = {"network": {}, "free": FREE_POINTS, "both": WITH_RESIDUAL}
every_kind = pytest.mark.parametrize("kind", KINDS)


def some_points(count: int = 30) -> torch.Tensor:
    return torch.rand(count, 3, generator=torch.Generator().manual_seed(0)) - 0.5


def settings_of(kind: str, **changes) -> IndustnerfSettings:
    return settings("industnerf", **KINDS[kind], **changes)


def make_field(config: IndustnerfSettings, *initial: torch.Tensor) -> Field:
    torch.manual_seed(0)
    field = Field(make_test_scene(ball(18.0), 3, 24), config)
    field.set_points(some_points(), *initial)
    return field


def perturb(field: Field) -> None:
    """Every parameter takes a value of its own."""
    generator = torch.Generator().manual_seed(1)
    with torch.no_grad():
        for weights in field.parameters():
            weights += 0.1 * torch.randn(weights.shape, generator=generator)


@every_kind
@pytest.mark.parametrize("activation", ["truncated_exp", "relu", "softplus"])
def test_it_starts_uniform_and_in_the_colors_that_views_see(kind, activation):
    config = settings_of(kind, density_bias=0.5, readings={"density_activation": activation})
    field = make_field(config)
    sigma, rgb = field()
    unit = grid_spacing(config.grid_res, 0)
    expected = activate(torch.full((30,), 0.5), activation, unit, config.max_raw_density)
    torch.testing.assert_close(sigma, expected)
    expected_rgb = (
        field.source_features.pooled_colors().clamp(COLOR_EPS, 1 - COLOR_EPS)
        if kind != "free"
        else GRAY
    )
    torch.testing.assert_close(rgb, torch.zeros(30, 3) + expected_rgb)


def test_density_per_first_spacing_does_not_depend_on_the_grid():
    """Raw values mean the same opacity of a cell, whatever its size."""
    coarse, fine = (make_field(settings_of("free", grid_res=res))()[0] for res in (8, 16))
    torch.testing.assert_close(fine, 2 * coarse)


def test_free_points_are_what_they_are_told():
    raw, rgb = torch.linspace(-7, 4, 30), torch.linspace(-0.2, 1.2, 90).reshape(30, 3)
    config = settings_of("free")
    sigma, color = make_field(config, raw, rgb)()
    unit = grid_spacing(config.grid_res, 0)
    assert torch.equal(
        sigma, activate(raw, config.readings.density_activation, unit, config.max_raw_density)
    )
    assert torch.equal(color, rgb.clamp(0, 1))


def test_residuals_add_to_the_network():
    """In raw density and in color; relu so that densities add up too."""
    readings = {"density_activation": "relu"}
    alone = make_field(
        settings_of("network", density_bias=6.0, max_raw_density=9.0, readings=readings)
    )
    both = make_field(settings_of("both", density_bias=6.0, max_raw_density=9.0, readings=readings))
    perturb(alone)
    both.load_state_dict(alone.state_dict() | {"raw": both.raw, "rgb": both.rgb})
    with torch.no_grad():
        both.raw += 0.25
        both.rgb += 0.01
    unit = grid_spacing(12, 0)
    (sigma, rgb), (more, brighter) = alone(), both()
    assert sigma.std() > 0
    # float32 of a density in 1 / 0.17
    torch.testing.assert_close(more - sigma, torch.full((30,), 0.25 / unit), rtol=1e-4, atol=1e-4)
    torch.testing.assert_close(brighter, (rgb + 0.01).clamp(0, 1), rtol=0, atol=1e-6)


@every_kind
def test_keeping_points_keeps_what_they_are(kind):
    field = make_field(settings_of(kind))
    perturb(field)
    indices = torch.tensor([12, 3, 25, 4])
    before = [values[indices] for values in field()]
    field.select_points(indices)
    for a, b in zip(before, field(), strict=True):
        torch.testing.assert_close(b, a, rtol=0, atol=1e-5)  # float32, matrices of another size


@every_kind
def test_all_that_is_to_be_learned_is_in_one_group_and_has_a_gradient(kind):
    field = make_field(settings_of(kind, density_bias=1.0))
    perturb(field)
    if field.source_features:
        field.source_features.refresh_views(torch.tensor([0]))
    sigma, rgb = field()
    (sigma.sum() + rgb.sum()).backward()
    named = [p for group in field.param_groups() for p in group["params"]]
    assert len({id(p) for p in named}) == len(named)
    assert {id(p) for p in named} == {id(p) for p in field.parameters()}
    assert all((p.grad != 0).any() for p in named)


def test_each_group_has_its_rate():
    field = make_field(settings_of("both"))
    rates = {id(p): group["lr"] for group in field.param_groups() for p in group["params"]}
    config = settings_of("both")
    assert rates[id(field.raw)] == config.residual.density_lr
    assert rates[id(field.rgb)] == config.residual.color_lr
    assert rates[id(field.network.head.bias)] == config.network.lr
    assert rates[id(field.network.skip.weight)] == config.network.skip_lr
    assert rates[id(field.source_features.encoder.conv3.weight)] == config.network.encoder_lr


@pytest.mark.parametrize("encoder", ["none", "frozen"])
def test_an_encoder_that_is_not_trained_is_in_no_group(encoder):
    field = make_field(settings_of("network", readings={"encoder": encoder}))
    named = {id(p) for group in field.param_groups() for p in group["params"]}
    assert named == {id(p) for p in field.network.parameters()}


@every_kind
def test_what_points_learn_by_themselves(kind):
    field = make_field(settings_of(kind))
    own = [] if kind == "network" else [field.raw, field.rgb]
    assert [id(p) for p in field.point_parameters()] == [id(p) for p in own]


def test_free_points_are_brought_back_to_where_they_have_a_gradient():
    config = settings_of("free")
    field = make_field(config)
    with torch.no_grad():
        field.raw.copy_(torch.linspace(-50, 50, 30))
        field.rgb.copy_(torch.linspace(-3, 3, 90).reshape(30, 3))
    before = [values.clone() for values in field()]
    field.clamp_parameters()
    assert all(torch.equal(a, b) for a, b in zip(before, field(), strict=True))
    assert (field.raw.min(), field.raw.max()) == (EMPTY_RAW_DENSITY, config.max_raw_density)
    assert (field.rgb.min(), field.rgb.max()) == (0, 1)


def test_free_points_that_relu_cuts_off_learn_again():
    """A density can grow from 0, but from a raw value below it no gradient leads back."""
    field = make_field(
        settings_of("free", density_bias=1.0, readings={"density_activation": "relu"})
    )
    with torch.no_grad():
        field.raw.fill_(-50)
    field.clamp_parameters()
    sigma, _ = field()
    sigma.sum().backward()
    assert (sigma == 0).all()
    assert (field.raw.grad > 0).all()


def test_residuals_beside_a_network_are_left_alone():
    field = make_field(settings_of("both"))
    with torch.no_grad():
        field.raw.fill_(-50)
    field.clamp_parameters()
    assert (field.raw == -50).all()


@every_kind
def test_moving_on_to_other_points_keeps_what_is_learned_of_all(kind):
    """Inputs are not normalized anew: a point that is placed again is what it was."""
    field = make_field(settings_of(kind))
    perturb(field)
    own = [p.detach() for p in field.point_parameters()]
    field.set_points(some_points(), *own)  # the views are encoded with the weights as they are now
    before = [values.detach() for values in field()]
    field.set_points(some_points()[:7] * 0.1)
    field.set_points(some_points(), *own)
    assert all(torch.equal(a, b) for a, b in zip(before, field(), strict=True))


def test_views_that_are_first_heeded_are_counted_as_n_is_used_to():
    """Mean and deviation of N's inputs stay; which point has which does not."""
    field = make_field(settings_of("network"))
    unweighted = (field.source_features() - field._mean) / field._deviation
    view_weights = torch.rand(3, 30, generator=torch.Generator().manual_seed(2))
    field.set_points(some_points(), view_weights=view_weights)
    weighted = (field.source_features() - field._mean) / field._deviation
    assert (weighted - unweighted).abs().max() > 0.1
    torch.testing.assert_close(weighted.mean(0), unweighted.mean(0), rtol=0, atol=1e-4)
    varied = field.source_features().std(0) > 0.011  # less counts as that
    torch.testing.assert_close(
        weighted.std(0)[varied], unweighted.std(0)[varied], rtol=1e-3, atol=1e-4
    )


def test_inputs_are_normalized_once_until_they_change():
    field = make_field(settings_of("network"))
    sources = field.source_features
    changes = [
        lambda: sources.refresh_views(torch.tensor([0, 2])),
        lambda: None,  # the gradient of the views that were refreshed was for one pass
        lambda: field.set_view_weights(torch.rand(3, 30)),
        lambda: field.select_points(torch.arange(20)),
        sources.recompute_features,
        lambda: field.set_points(some_points()),
    ]
    for change in changes:
        change()
        inputs = field._network_inputs()
        assert torch.equal(inputs, (sources() - field._mean) / field._deviation)
        assert field._network_inputs() is field._network_inputs()


@every_kind
def test_one_point_that_is_left_has_a_density(kind):
    """The deviation of one row is 0, not NaN: NaN is above no threshold, and looks empty."""
    field = make_field(settings_of(kind))
    perturb(field)
    field.set_points(some_points(1))
    values = field()
    tensors = values if isinstance(values, tuple) else (values,)
    assert all(torch.isfinite(each).all() for each in tensors)
