"""The field with points of its own, with a network, and with both."""

import pytest
import torch

from industnerf.methods.industnerf.field import EMPTY, Field
from industnerf.methods.industnerf.levels import spacing_of
from industnerf.methods.industnerf.network import PURE, activate
from industnerf.methods.industnerf.sources import GREY
from industnerf.schema import IndustnerfSettings
from tests.methods.industnerf.scenes import BOTH, FREE, ball, scene, settings

KINDS = {"network": {}, "free": FREE, "both": BOTH}
every_kind = pytest.mark.parametrize("kind", KINDS)


def some_points(count: int = 30) -> torch.Tensor:
    return torch.rand(count, 3, generator=torch.Generator().manual_seed(0)) - 0.5


def settings_of(kind: str, **changes) -> IndustnerfSettings:
    return settings("industnerf", **KINDS[kind], **changes)


def placed(ways: IndustnerfSettings, *start: torch.Tensor) -> Field:
    torch.manual_seed(0)
    field = Field(scene(ball(18.0), 3, 24), ways)
    field.place(some_points(), *start)
    return field


def stir(field: Field) -> None:
    """Every parameter takes a value of its own."""
    generator = torch.Generator().manual_seed(1)
    with torch.no_grad():
        for weights in field.parameters():
            weights += 0.1 * torch.randn(weights.shape, generator=generator)


@every_kind
@pytest.mark.parametrize("activation", ["cut_exp", "relu", "softplus"])
def test_it_starts_uniform_and_in_the_colours_that_views_see(kind, activation):
    ways = settings_of(kind, initial=0.5, readings={"activation": activation})
    field = placed(ways)
    sigma, rgb = field()
    unit = spacing_of(ways.grid_res, 0)
    truth = activate(torch.full((30,), 0.5), activation, unit, ways.ceiling)
    torch.testing.assert_close(sigma, truth)
    seen = field.sources.colours().clamp(PURE, 1 - PURE) if kind != "free" else GREY
    torch.testing.assert_close(rgb, torch.zeros(30, 3) + seen)


def test_density_per_first_spacing_does_not_depend_on_the_grid():
    """Raw values mean the same opacity of a cell, whatever its size."""
    coarse, fine = (placed(settings_of("free", grid_res=res))()[0] for res in (8, 16))
    torch.testing.assert_close(fine, 2 * coarse)


def test_free_points_are_what_they_are_told():
    raw, rgb = torch.linspace(-7, 4, 30), torch.linspace(-0.2, 1.2, 90).reshape(30, 3)
    ways = settings_of("free")
    sigma, colour = placed(ways, raw, rgb)()
    unit = spacing_of(ways.grid_res, 0)
    assert torch.equal(sigma, activate(raw, ways.readings.activation, unit, ways.ceiling))
    assert torch.equal(colour, rgb.clamp(0, 1))


def test_residuals_add_to_the_network():
    """In raw density and in colour; relu so that densities add up too."""
    readings = {"activation": "relu"}
    alone = placed(settings_of("network", initial=6.0, ceiling=9.0, readings=readings))
    both = placed(settings_of("both", initial=6.0, ceiling=9.0, readings=readings))
    stir(alone)
    both.load_state_dict(alone.state_dict() | {"raw": both.raw, "rgb": both.rgb})
    with torch.no_grad():
        both.raw += 0.25
        both.rgb += 0.01
    unit = spacing_of(12, 0)
    (sigma, rgb), (more, brighter) = alone(), both()
    assert sigma.std() > 0
    # float32 of a density in 1 / 0.17
    torch.testing.assert_close(more - sigma, torch.full((30,), 0.25 / unit), rtol=1e-4, atol=1e-4)
    torch.testing.assert_close(brighter, (rgb + 0.01).clamp(0, 1), rtol=0, atol=1e-6)


@every_kind
def test_keeping_points_keeps_what_they_are(kind):
    field = placed(settings_of(kind))
    stir(field)
    which = torch.tensor([12, 3, 25, 4])
    before = [values[which] for values in field()]
    field.keep(which)
    for a, b in zip(before, field(), strict=True):
        torch.testing.assert_close(b, a, rtol=0, atol=1e-5)  # float32, matrices of another size


@every_kind
def test_all_that_is_to_be_learned_is_in_one_group_and_has_a_gradient(kind):
    field = placed(settings_of(kind, initial=1.0))
    stir(field)
    if field.sources:
        field.sources.refresh(torch.tensor([0]))
    sigma, rgb = field()
    (sigma.sum() + rgb.sum()).backward()
    named = [p for group in field.groups() for p in group["params"]]
    assert len({id(p) for p in named}) == len(named)
    assert {id(p) for p in named} == {id(p) for p in field.parameters()}
    assert all((p.grad != 0).any() for p in named)


def test_each_group_has_its_rate():
    field = placed(settings_of("both"))
    rates = {id(p): group["lr"] for group in field.groups() for p in group["params"]}
    ways = settings_of("both")
    assert rates[id(field.raw)] == ways.residual.density_rate
    assert rates[id(field.rgb)] == ways.residual.colour_rate
    assert rates[id(field.network.head.bias)] == ways.network.rate
    assert rates[id(field.network.straight.weight)] == ways.network.straight_rate
    assert rates[id(field.sources.encoder.last.weight)] == ways.network.encoder_rate


@pytest.mark.parametrize("encoder", ["none", "frozen"])
def test_an_encoder_that_is_not_trained_is_in_no_group(encoder):
    field = placed(settings_of("network", readings={"encoder": encoder}))
    named = {id(p) for group in field.groups() for p in group["params"]}
    assert named == {id(p) for p in field.network.parameters()}


@every_kind
def test_what_points_learn_by_themselves(kind):
    field = placed(settings_of(kind))
    own = [] if kind == "network" else [field.raw, field.rgb]
    assert [id(p) for p in field.own()] == [id(p) for p in own]


def test_free_points_are_brought_back_to_where_they_have_a_gradient():
    ways = settings_of("free")
    field = placed(ways)
    with torch.no_grad():
        field.raw.copy_(torch.linspace(-50, 50, 30))
        field.rgb.copy_(torch.linspace(-3, 3, 90).reshape(30, 3))
    before = [values.clone() for values in field()]
    field.settle()
    assert all(torch.equal(a, b) for a, b in zip(before, field(), strict=True))
    assert (field.raw.min(), field.raw.max()) == (EMPTY, ways.ceiling)
    assert (field.rgb.min(), field.rgb.max()) == (0, 1)


def test_free_points_that_relu_cuts_off_learn_again():
    """A density can grow from 0, but from a raw value below it no gradient leads back."""
    field = placed(settings_of("free", initial=1.0, readings={"activation": "relu"}))
    with torch.no_grad():
        field.raw.fill_(-50)
    field.settle()
    sigma, _ = field()
    sigma.sum().backward()
    assert (sigma == 0).all()
    assert (field.raw.grad > 0).all()


def test_residuals_beside_a_network_are_left_alone():
    field = placed(settings_of("both"))
    with torch.no_grad():
        field.raw.fill_(-50)
    field.settle()
    assert (field.raw == -50).all()


@every_kind
def test_moving_on_to_other_points_keeps_what_is_learned_of_all(kind):
    """Inputs are not normalised anew: a point that is placed again is what it was."""
    field = placed(settings_of(kind))
    stir(field)
    own = [p.detach() for p in field.own()]
    field.place(some_points(), *own)  # the views are encoded with the weights as they are now
    before = [values.detach() for values in field()]
    field.place(some_points()[:7] * 0.1)
    field.place(some_points(), *own)
    assert all(torch.equal(a, b) for a, b in zip(before, field(), strict=True))


def test_views_that_are_first_heeded_are_counted_as_n_is_used_to():
    """Mean and deviation of N's inputs stay; which point has which does not."""
    field = placed(settings_of("network"))
    told = (field.sources() - field._mean) / field._deviation
    trust = torch.rand(3, 30, generator=torch.Generator().manual_seed(2))
    field.place(some_points(), trust=trust)
    heeded = (field.sources() - field._mean) / field._deviation
    assert (heeded - told).abs().max() > 0.1
    torch.testing.assert_close(heeded.mean(0), told.mean(0), rtol=0, atol=1e-4)
    varied = field.sources().std(0) > 0.011  # less counts as that
    torch.testing.assert_close(heeded.std(0)[varied], told.std(0)[varied], rtol=1e-3, atol=1e-4)
