"""The Chamfer distance against closed forms and against a loop over all pairs."""

import numpy as np
import pytest
import torch
from scipy.spatial import cKDTree

from industnerf.methods.atlasnet.chamfer import chamfer, nearest_brute_force
from industnerf.methods.atlasnet.nearest_kernel import nearest_compiled


def clouds(n=40, m=60, batch=3, dtype=torch.float32):
    rng = np.random.default_rng(0)
    return [torch.tensor(rng.random((batch, count, 3)) - 0.5, dtype=dtype) for count in (n, m)]


SMOOTHED = 1e-3  # a mean may be less by this than that of the distances, so both ways by twice it


def test_of_two_points_it_is_twice_their_distance():
    a, b = torch.tensor([[[0.0, 0, 0]]]), torch.tensor([[[1.0, 2, 2]]])
    assert chamfer(a, b).item() == pytest.approx(2 * 3, abs=2 * SMOOTHED)


def test_each_way_is_a_mean_of_its_own():
    """Of two points one lies on the only point there, the other 3 from it: 3 / 2 and 0."""
    a, b = torch.tensor([[[0.0, 0, 0], [3, 0, 0]]]), torch.tensor([[[0.0, 0, 0]]])
    assert chamfer(a, b).item() == pytest.approx(1.5, abs=SMOOTHED)
    assert chamfer(b, a).item() == pytest.approx(1.5, abs=SMOOTHED)


def test_it_is_what_a_loop_over_all_pairs_finds():
    a, b = clouds()
    expected = 0.0
    for one, other in ((a.numpy(), b.numpy()), (b.numpy(), a.numpy())):
        pairs = zip(one, other, strict=True)
        expected += np.mean([min(np.linalg.norm(p - q) for q in y) for x, y in pairs for p in x])
    assert chamfer(a, b).item() == pytest.approx(expected, abs=2 * SMOOTHED)


def test_the_order_of_points_is_no_matter():
    a, _ = clouds()
    assert chamfer(a, a.flip(1)).item() == 0


def test_its_gradient_is_that_of_small_steps():
    a, b = clouds(4, 5, 2, torch.float64)
    a.requires_grad_()
    # no point is as near to two others as 1e-6, so that no nearest one changes
    assert torch.autograd.gradcheck(lambda x: chamfer(x, b), a, eps=1e-6)
    assert torch.autograd.gradcheck(lambda y: chamfer(a.detach(), y), b.requires_grad_(), eps=1e-6)


def test_at_the_surface_the_gradient_does_not_fade():
    """A hundredth of a part away it is still nearly 1, of the square it would be 0.02."""
    a, b = torch.zeros(1, 1, 3, requires_grad=True), torch.tensor([[[0.01, 0, 0]]])
    chamfer(a, b).backward()
    assert a.grad.norm().item() == pytest.approx(2, rel=0.01)


def test_where_points_meet_the_gradient_is_0():
    a, _ = clouds()
    moved = a.clone().requires_grad_()
    chamfer(moved, a).backward()
    assert not moved.grad.any()


@pytest.mark.parametrize("nearest", [nearest_compiled, nearest_brute_force])
def test_nearest_points_are_those_of_a_tree(nearest):
    a, b = clouds(500, 700)
    for found, one, other in zip(nearest(a, b), (a, b), (b, a), strict=True):
        for indices, points, candidates in zip(found, one, other, strict=True):
            least, _ = cKDTree(candidates).query(points)
            distance = (points - candidates[indices]).norm(dim=1)
            # squares are compared to a part in 2^13
            np.testing.assert_allclose(distance, least, rtol=2**-13)


def test_of_equally_near_points_it_is_the_first():
    a, b = torch.zeros(1, 1, 3), torch.ones(1, 5, 3)
    assert nearest_compiled(a, b)[0].tolist() == [[0]]
    assert nearest_compiled(b, a)[1].tolist() == [[0]]
