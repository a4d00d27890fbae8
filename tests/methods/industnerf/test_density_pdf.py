"""Eqs. (5)-(9) and draws by them: slow twins, exact inverses, chi-squared, empty cells."""

import math

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import chi2

from industnerf.errors import ReconstructionFailed
from industnerf.methods.industnerf.density_pdf import (
    inverse_transform_sample,
    latin_hypercube,
    marginal_x,
    marginal_xy,
    pdf,
    sampling_density,
    y_given_x,
    z_given_xy,
)

SEEDS = st.integers(0, 2**32 - 1)
SHAPE = (4, 3, 5)
N = 60_000


def seeded(seed: int) -> torch.Generator:
    return torch.Generator().manual_seed(seed)


def grid(seed: int, empty: float = 0.4) -> torch.Tensor:
    """Densities over six orders of magnitude, a share of them zero, but not all."""
    generator = seeded(seed)
    sigma = torch.exp(14 * torch.rand(SHAPE, dtype=torch.float64, generator=generator) - 7)
    sigma[torch.rand(SHAPE, generator=generator) < empty] = 0
    sigma[1, 2, 3] = 1
    return sigma


def uniforms(count: int, seed: int) -> torch.Tensor:
    return torch.rand(count, 3, dtype=torch.float64, generator=seeded(seed))


@given(SEEDS)
def test_marginals_and_conditionals_are_the_sums_that_the_paper_writes(seed):
    sigma = grid(seed).numpy()
    p, rx, ry, rz = pdf(torch.tensor(sigma)), *map(range, SHAPE)
    total = math.fsum(sigma.ravel())
    for x in rx:
        in_x = math.fsum(sigma[x].ravel())
        assert marginal_x(p)[x].item() == pytest.approx(in_x / total, rel=1e-13)
        for y in ry:
            in_xy = math.fsum(sigma[x, y])
            assert marginal_xy(p)[x, y].item() == pytest.approx(in_xy / total, rel=1e-13)
            given_x = in_xy / in_x if in_x else 0
            assert y_given_x(p)[x, y].item() == pytest.approx(given_x, rel=1e-13)
            for z in rz:
                given_xy = sigma[x, y, z] / in_xy if in_xy else 0
                assert z_given_xy(p)[x, y, z].item() == pytest.approx(given_xy, rel=1e-13)


def test_the_chain_of_conditionals_is_the_pdf():
    p = pdf(grid(0))
    chain = marginal_x(p)[:, None, None] * y_given_x(p)[:, :, None] * z_given_xy(p)
    torch.testing.assert_close(chain, p, rtol=1e-13, atol=0)


@pytest.mark.parametrize("equation", [pdf, marginal_xy, marginal_x, y_given_x, z_given_xy])
def test_gradients_are_right_where_there_is_mass(equation):
    """(5) to (9), of densities that are weighed by visibility.  A row without mass, which is set to
    0 where it would be 0 / 0, has no gradient; nor has a draw, so that nothing asks for one."""
    sigma, visibility = (0.5 + torch.rand(2, 2, 3, 2, generator=seeded(4)).double()).unbind()

    def value(*given: torch.Tensor) -> torch.Tensor:
        p = pdf(sampling_density(*given, "visible_density"))
        return p if equation is pdf else equation(p)

    assert torch.autograd.gradcheck(value, (sigma.requires_grad_(), visibility.requires_grad_()))


def invert_slowly(sigma: np.ndarray, u: list[float]) -> list[float]:
    """One draw, cell by cell: the x, y and z at which the distribution functions reach `u`."""
    cells, left = [], sigma
    for share in u:
        mass = [math.fsum(slab.ravel()) for slab in left]
        target, cell = share * math.fsum(mass), 0
        while target >= mass[cell]:
            target -= mass[cell]
            cell += 1
        cells.append(cell + target / mass[cell])
        left = left[cell]
    return cells


@given(SEEDS)
def test_draws_are_those_of_a_loop_over_cells(seed):
    sigma, u = grid(seed), uniforms(20, seed)
    expected = [invert_slowly(sigma.numpy(), row) for row in u.tolist()]
    # A cell's mass may be 1e-6 of its row's: rounding of 1e-16 of the row is 1e-10 of the cell.
    actual = inverse_transform_sample(sigma, u, "jitter")
    torch.testing.assert_close(
        actual, torch.tensor(expected, dtype=torch.float64), rtol=0, atol=1e-8
    )


@given(SEEDS)
def test_the_uniforms_come_back_through_the_distribution_functions(seed):
    """An exact inverse: F(x) = u, F(y | x) = u' and F(z | x, y) = u'' at every draw."""
    sigma, u = grid(seed), uniforms(20, seed)
    drawn, p = inverse_transform_sample(sigma, u, "jitter"), pdf(sigma)
    x, y, _ = drawn.floor().long().T
    rows = [marginal_x(p).expand(20, -1), y_given_x(p)[x], z_given_xy(p)[x, y]]
    for axis, mass in enumerate(rows):
        cells = torch.arange(mass.shape[1])
        filled = (drawn[:, axis : axis + 1] - cells).clamp(0, 1)  # share of each cell to the left
        # a position near 5 is rounded by 1e-15, in a cell with all the mass
        torch.testing.assert_close((mass * filled).sum(1), u[:, axis], rtol=0, atol=1e-14)


def test_draws_follow_the_density():
    sigma = torch.rand(SHAPE, dtype=torch.float64, generator=seeded(0))
    sigma[0, 1] = 0
    expected = N * pdf(sigma)
    drawn = inverse_transform_sample(sigma, uniforms(N, 1), "jitter")
    x, y, z = drawn.floor().long().T
    count = torch.zeros(SHAPE, dtype=torch.float64).index_put(
        (x, y, z), torch.ones(N).double(), True
    )
    assert expected[expected > 0].min() > 5  # the rule for chi-squared
    some = expected > 0
    statistic = ((count - expected)[some] ** 2 / expected[some]).sum().item()
    assert statistic < chi2.isf(1e-4, int(some.sum()) - 1)  # by chance once in 10 000 seeds
    # within their cells uniform and independent: means, variances and covariances
    within = drawn - drawn.floor() - 0.5
    assert within.mean(0).abs().max() < 4 / math.sqrt(12 * N)  # by chance once in 5000 seeds
    spread = within.T @ within / N
    assert (spread - torch.eye(3) / 12).abs().max() < 4 / 12 / math.sqrt(N)


def test_a_product_of_three_densities_is_drawn_axis_by_axis():
    """Its conditionals are the axes' own: each axis is inverted by itself."""
    a, b, c = (torch.rand(n, dtype=torch.float64, generator=seeded(n)) for n in SHAPE)
    u = uniforms(500, 2)
    actual = inverse_transform_sample(a[:, None, None] * b[:, None] * c, u, "jitter")
    for axis, density in enumerate((a, b, c)):
        edges = np.concatenate([[0], np.cumsum(density.numpy())])
        alone = np.interp(u[:, axis].numpy() * edges[-1], edges, np.arange(len(edges)))
        np.testing.assert_allclose(actual[:, axis], alone, rtol=0, atol=1e-12)


@given(SEEDS, st.floats(0.5, 0.98))
def test_cells_without_density_are_never_drawn(seed, empty):
    """Not even by the first and the last uniform, nor by one that rounds to the last."""
    sigma = grid(seed, empty)
    ends = torch.tensor([0.0, 5e-324, 0.5, 1 - 2**-53, 1], dtype=torch.float64)
    u = torch.cat([torch.cartesian_prod(ends, ends, ends), uniforms(100, seed)])
    for reading in ("jitter", "center"):
        drawn = inverse_transform_sample(sigma, u, reading)
        x, y, z = drawn.floor().long().T
        assert (sigma[x, y, z] > 0).all()


@pytest.mark.parametrize("u", [0.0, 1.0])
def test_one_cell_gets_everything(u):
    sigma = torch.zeros(SHAPE)
    sigma[3, 0, 2] = 1e-30
    corner = torch.tensor([[3.0, 0, 2]], dtype=torch.float64)
    actual = inverse_transform_sample(sigma, torch.full((1, 3), u), "jitter")
    torch.testing.assert_close(actual, corner + u, rtol=0, atol=1e-14)
    assert (actual.floor() == corner).all()
    assert (inverse_transform_sample(sigma, torch.full((1, 3), u), "center") == corner + 0.5).all()


def test_centers_are_those_of_the_cells_that_jitter_draws():
    sigma, u = grid(3), uniforms(200, 3)
    center = inverse_transform_sample(sigma, u, "center")
    assert (center == inverse_transform_sample(sigma, u, "jitter").floor() + 0.5).all()


@given(SEEDS, st.sampled_from([1e-300, 1e-30, 1e30, 1e300]))
def test_the_unit_of_density_does_not_matter(seed, scale):
    sigma, u = grid(seed), uniforms(20, seed)
    actual = inverse_transform_sample(sigma * scale, u, "jitter")
    torch.testing.assert_close(
        actual, inverse_transform_sample(sigma, u, "jitter"), rtol=0, atol=1e-8
    )


def test_draws_have_no_gradient():
    assert not inverse_transform_sample(
        grid(0).requires_grad_(), uniforms(3, 0), "jitter"
    ).requires_grad


def test_visibility_weighs_density_only_where_asked():
    sigma, visibility = torch.tensor([[[2.0, 3]]]), torch.tensor([[[0.0, 0.5]]])
    assert sampling_density(sigma, visibility, "density").tolist() == [[[2, 3]]]
    assert sampling_density(sigma, visibility, "visible_density").tolist() == [[[0, 1.5]]]


@pytest.mark.parametrize("bad", [-1e-3, math.nan, math.inf])
def test_densities_that_are_none_are_refused_and_counted(bad):
    sigma = grid(0)
    sigma[0, 0, :2] = bad
    with pytest.raises(ReconstructionFailed, match="2 of 60 densities are negative or not finite"):
        pdf(sigma)


def test_an_empty_field_is_refused():
    with pytest.raises(ReconstructionFailed, match="all 60 densities are zero"):
        inverse_transform_sample(torch.zeros(SHAPE), uniforms(3, 0), "jitter")


def test_stratified_uniforms_have_one_in_every_stratum_of_every_axis():
    actual = latin_hypercube(50, seeded(0))
    assert (actual * 50).floor().long().sort(dim=0).values.T.tolist() == [list(range(50))] * 3
    assert not torch.equal(actual[:, 0].argsort(), actual[:, 1].argsort())
    torch.testing.assert_close(actual, latin_hypercube(50, seeded(0)), rtol=0, atol=0)
