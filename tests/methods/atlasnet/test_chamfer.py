"""The Chamfer distance against closed forms and against a loop over all pairs."""

import numpy as np
import torch

from industnerf.methods.atlasnet.chamfer import chamfer, nearest_brute_force, nearest_kdtree


def clouds(n=40, m=60, batch=3, dtype=torch.float32):
    rng = np.random.default_rng(0)
    return [torch.tensor(rng.random((batch, count, 3)) - 0.5, dtype=dtype) for count in (n, m)]


def test_of_two_points_it_is_twice_their_squared_distance():
    a, b = torch.tensor([[[0.0, 0, 0]]]), torch.tensor([[[1.0, 2, 2]]])
    assert chamfer(a, b).item() == 2 * 9


def test_each_way_is_a_mean_of_its_own():
    """Of two points one lies on the only point there, the other 3 from it: 9 / 2 and 0."""
    a, b = torch.tensor([[[0.0, 0, 0], [3, 0, 0]]]), torch.tensor([[[0.0, 0, 0]]])
    assert chamfer(a, b).item() == 4.5
    assert chamfer(b, a).item() == 4.5


def test_it_is_what_a_loop_over_all_pairs_finds():
    a, b = clouds()
    expected = 0.0
    for one, other in ((a.numpy(), b.numpy()), (b.numpy(), a.numpy())):
        pairs = zip(one, other, strict=True)
        expected += np.mean([min(((p - q) ** 2).sum() for q in y) for x, y in pairs for p in x])
    np.testing.assert_allclose(chamfer(a, b), expected, rtol=1e-6)  # float32 means


def test_the_order_of_points_is_no_matter():
    a, _ = clouds()
    assert chamfer(a, a.flip(1)).item() == 0


def test_its_gradient_is_that_of_small_steps():
    a, b = clouds(4, 5, 2, torch.float64)
    a.requires_grad_()
    # no point is as near to two others as 1e-6, so that no nearest one changes
    assert torch.autograd.gradcheck(lambda x: chamfer(x, b), a, eps=1e-6)
    assert torch.autograd.gradcheck(lambda y: chamfer(a.detach(), y), b.requires_grad_(), eps=1e-6)


def test_trees_and_distances_agree():
    a, b = clouds(500, 700)
    # Where two candidates differ by less than a float32's rounding, either may be named: none here.
    for one, other in zip(nearest_kdtree(a, b), nearest_brute_force(a, b), strict=True):
        assert torch.equal(one, other)
