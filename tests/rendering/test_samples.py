import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.rendering.samples import radiance_points, sample_distances

LO, HI = torch.tensor([-1.0, -1, -1]).double(), torch.tensor([1.0, 2, 3]).double()


def f64(*x) -> torch.Tensor:
    return torch.tensor(x, dtype=torch.float64)


def places(origin, direction, offset=0.5, step=0.5) -> list[float]:
    """t of the samples of one ray."""
    t, inside = sample_distances(f64(origin), f64(direction), f64(offset), LO, HI, step)
    assert (t[~inside] == 0).all()
    return t[inside].tolist()


def test_samples_begin_where_the_ray_enters():
    assert places([-3.0, 0, 0], [1.0, 0, 0]) == [2.25, 2.75, 3.25, 3.75]
    assert places([-3.0, 0, 0], [1.0, 0, 0], offset=0.0) == [2, 2.5, 3, 3.5]  # 4 is the exit
    assert places([0.0, 0, 7], [0.0, 0, -1], step=1.5, offset=0.9) == [4 + 1.35, 4 + 2.85]


def test_samples_begin_at_an_eye_inside():
    assert places([0.0, 0, 0], [0.0, 1, 0], step=1.0) == [0.5, 1.5]


@pytest.mark.parametrize(
    ("origin", "direction"),
    [
        ([3.0, 0, 0], [1.0, 0, 0]),  # behind the eye
        ([3.0, 0, 0], [0.0, 1, 0]),  # past, along a face
        ([3.0, 3, 0], [-0.6, 0.8, 0]),  # past, at an angle
        ([1.0, 0, 0], [0.0, 1, 0]),  # in the upper face itself
    ],
)
def test_a_ray_that_misses_has_no_samples(origin, direction):
    assert places(origin, direction) == []


def test_the_lower_face_belongs_to_the_cube():
    assert places([-1.0, 0, 0], [0.0, 1, 0], step=1.0) == [0.5, 1.5]
    assert places([-1.0, 0, 0], [-0.0, 1, 0], step=1.0) == [0.5, 1.5]


@given(st.integers(0, 2**32 - 1), st.floats(0.01, 1.0))
def test_samples_fill_the_ray_inside_the_cube_and_nothing_else(seed, step):
    rng = torch.Generator().manual_seed(seed)
    origins = 4 * torch.rand(20, 3, generator=rng, dtype=torch.float64) - 2
    directions = torch.randn(20, 3, generator=rng, dtype=torch.float64)
    directions /= directions.norm(dim=1, keepdim=True)
    offsets = torch.rand(20, generator=rng, dtype=torch.float64)
    t, inside = sample_distances(origins, directions, offsets, LO, HI, step)
    at = origins[:, None] + t[..., None] * directions[:, None]
    assert ((at >= LO - 1e-12) & (at <= HI + 1e-12)).all(dim=2)[inside].all()  # a few roundings
    for o, d, u, mine in zip(origins, directions, offsets, t, strict=True):
        fine = torch.arange(0, 12, 1e-3, dtype=torch.float64)  # the ray, finely
        line = o + fine[:, None] * d
        chord = int(((line >= LO) & (line < HI)).all(dim=1).sum()) * 1e-3
        # as many q >= 0 as have (q + u) step < chord, which is known to within 2e-3
        minimum, most = (max(0, math.ceil((c / step) - u)) for c in (chord - 2e-3, chord + 2e-3))
        assert minimum <= (mine > 0).sum() <= most


def test_no_rays_at_all():
    nobody = torch.empty(0, 3).double()
    t, inside = sample_distances(nobody, nobody, torch.empty(0).double(), LO, HI, 0.5)
    assert len(t) == len(inside) == 0


def test_samples_outside_the_cube_have_no_neighbors():
    """Not even where the eye is, though t = 0 stands for such a sample."""
    rays = f64([3.0, 0, 0], [-3.0, 0, 0]), f64([1.0, 0, 0], [1.0, 0, 0]), f64(0.5, 0.5)
    result = radiance_points(
        *rays, LO, HI, f64([3.0, 0, 0], [-0.75, 0, 0]), step=0.5, radius=0.5, k=2, weights="inverse"
    )
    assert (result.ids[0] == -1).all()
    assert result.ids[1, :2].tolist() == [[1, -1], [-1, -1]]


def test_means_are_taken_sample_by_sample():
    points, values = f64([-0.75, 0, 0], [-0.25, 0.25, 0], [-0.25, -0.125, 0]), f64([1], [5], [8])
    rays = f64([-3.0, 0, 0]), f64([1.0, 0, 0]), f64(0.5)
    result = radiance_points(
        *rays, LO, HI, points, step=0.5, radius=0.3, k=8, weights="inverse"
    ).mean(values.double())
    assert result[0, :3, 0].tolist() == [1, (5 / 0.25 + 8 / 0.125) / (1 / 0.25 + 1 / 0.125), 0]
