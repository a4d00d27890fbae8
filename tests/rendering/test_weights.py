import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from jaxtyping import TypeCheckError

from industnerf.rendering.weights import (
    FLOOR,
    inverse_distance_weights,
    trilinear_weights,
    weighted_mean,
)

READINGS = ["inverse", "inverse_square", "modified_shepard"]
RADIUS = 2.0
REACHED = 3  # neighbors in `padded`


def f64(*x) -> torch.Tensor:
    return torch.tensor(x, dtype=torch.float64)


def padded(seed: int) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    """Values of 6 points, and 4 rows of 3 neighbors and one that is missing; the last has none."""
    rng = torch.Generator().manual_seed(seed)
    ids = torch.stack([torch.randperm(6, generator=rng)[: REACHED + 1] for _ in range(4)])
    distance = 2 * torch.rand(4, REACHED + 1, generator=rng, dtype=torch.float64)
    ids[:, REACHED], distance[:, REACHED] = -1, torch.inf
    ids[3], distance[3] = -1, torch.inf
    return torch.rand(6, 2, generator=rng, dtype=torch.float64), ids, distance


@pytest.mark.parametrize(
    ("reading", "truth"),
    [
        ("inverse", [1 / 0.5, 1 / 1.0, 1 / 1.6]),
        ("inverse_square", [1 / 0.25, 1 / 1.0, 1 / 2.56]),
        ("modified_shepard", [(1.5 / (2 * 0.5)) ** 2, (1 / (2 * 1)) ** 2, (0.4 / (2 * 1.6)) ** 2]),
    ],
)
def test_each_reading_is_its_formula(reading, truth):
    result = inverse_distance_weights(f64(0.5, 1.0, 1.6), RADIUS, reading)
    torch.testing.assert_close(result, f64(*truth), rtol=1e-14, atol=0)  # a few eps


@pytest.mark.parametrize("reading", READINGS)
def test_from_the_radius_on_nothing_weighs(reading):
    beyond = f64(RADIUS, 1.5 * RADIUS, torch.inf)
    assert inverse_distance_weights(beyond, RADIUS, reading).tolist() == [0, 0, 0]
    assert inverse_distance_weights(f64(RADIUS - 1e-9), RADIUS, reading) > 0


@pytest.mark.parametrize(
    ("reading", "at_zero"),
    [
        ("inverse", 1 / (FLOOR * RADIUS)),
        ("inverse_square", 1 / (FLOOR * RADIUS) ** 2),
        (
            "modified_shepard",
            1 / (FLOOR * RADIUS) ** 2,
        ),  # the numerator is that of the true distance
    ],
)
def test_a_point_on_the_sample_weighs_as_one_at_the_floor(reading, at_zero):
    result = inverse_distance_weights(f64(0.0), RADIUS, reading)
    torch.testing.assert_close(result, f64(at_zero), rtol=1e-14, atol=0)


def test_only_the_tapered_weight_fades_out():
    edge = f64(RADIUS - 1e-6)
    # (1e-6 / (2 * 2))^2 against 1/2 and 1/4
    assert inverse_distance_weights(edge, RADIUS, "modified_shepard") < 1e-12
    assert inverse_distance_weights(edge, RADIUS, "inverse") > 0.49
    assert inverse_distance_weights(edge, RADIUS, "inverse_square") > 0.24


@pytest.mark.parametrize("reading", READINGS)
def test_nearer_points_never_weigh_less(reading):
    weights = inverse_distance_weights(
        torch.linspace(0, 3, 3001, dtype=torch.float64), RADIUS, reading
    )
    assert (weights.diff() <= 0).all()


def test_an_unknown_reading_is_refused():
    with pytest.raises(TypeCheckError):
        inverse_distance_weights(f64(1.0), RADIUS, "cubic")


def test_a_tent_is_refused_where_only_distances_are_known():
    with pytest.raises(ValueError, match="`trilinear_weights` takes the offsets"):
        inverse_distance_weights(f64(1.0), RADIUS, "trilinear")


def test_a_tent_is_a_product_over_the_axes_and_ends_on_a_cube():
    apart = f64([0, 0, 0], [1.0, -0.5, 0.2], [1.9, -1.9, 1.9], [0, RADIUS, 0], [0.1, 0, -3])
    truth = f64(1, 0.5 * 0.75 * 0.9, 0.05**3, 0, 0)  # 1.9 sqrt(3) is far beyond the radius
    # 1 - 1.9 / 2 is off by an eps, 2e-15 of it, three times
    torch.testing.assert_close(trilinear_weights(apart, RADIUS), truth, rtol=1e-14, atol=0)


@pytest.mark.parametrize("reading", READINGS)
@given(st.integers(0, 2**32 - 1))
def test_weights_are_a_partition_of_unity(reading, seed):
    """A field that is constant is found constant, wherever there is a neighbor at all."""
    _, ids, distance = padded(seed)
    weights = inverse_distance_weights(distance, RADIUS, reading)
    result = weighted_mean(torch.full((6, 1), 7.0, dtype=torch.float64), ids, weights)
    truth = f64(7, 7, 7, 0)[:, None]
    torch.testing.assert_close(result, truth, rtol=1e-14, atol=0)  # three products and a sum


@given(st.integers(0, 2**32 - 1))
def test_the_mean_lies_between_the_neighbors(seed):
    values, ids, distance = padded(seed)
    result = weighted_mean(values, ids, inverse_distance_weights(distance, RADIUS, "inverse"))
    three = values[ids[:3, :REACHED]]
    assert (result[:3] >= three.amin(dim=1) - 1e-15).all()  # an eps for the rounded shares
    assert (result[:3] <= three.amax(dim=1) + 1e-15).all()


def test_the_mean_by_hand():
    values, ids = f64([1.0, 10.0], [2.0, 20.0], [4.0, 40.0]), torch.tensor([[2, 0], [1, -1]])
    result = weighted_mean(values, ids, f64([3.0, 1.0], [0.5, 0.0]))
    truth = f64([(3 * 4 + 1) / 4, (3 * 40 + 10) / 4], [2.0, 20.0])
    torch.testing.assert_close(result, truth, rtol=1e-15, atol=0)


def test_the_gradient_is_right_and_finite_without_neighbors():
    values, ids, distance = padded(0)
    weights = inverse_distance_weights(distance, RADIUS, "inverse")
    values.requires_grad_()
    torch.autograd.gradcheck(lambda v: weighted_mean(v, ids, weights), values)
    nobody = torch.full((1, 2), -1), f64([0.0, 0.0])
    (gradient,) = torch.autograd.grad(weighted_mean(values, *nobody).sum(), values)
    assert gradient.abs().max() == 0


@pytest.mark.parametrize("reading", READINGS)
def test_gradients_of_weights_in_distance_are_right(reading):
    """Away from the floor and the radius, where they have kinks and jumps; beyond there is none."""
    distance = f64(0.2, 0.9, 1.7, 2.5).requires_grad_()
    assert torch.autograd.gradcheck(
        lambda d: inverse_distance_weights(d, RADIUS, reading), distance
    )


def test_gradients_of_a_tent_are_right_away_from_its_edges():
    apart = f64([0.3, -1.1, 0.7], [-1.5, 0.4, 2.6]).requires_grad_()
    assert torch.autograd.gradcheck(lambda x: trilinear_weights(x, RADIUS), apart)


def test_the_mean_over_an_empty_cloud_is_zero():
    result = weighted_mean(torch.empty(0, 4), torch.full((2, 3), -1), torch.zeros(2, 3))
    assert result.tolist() == [[0] * 4] * 2
