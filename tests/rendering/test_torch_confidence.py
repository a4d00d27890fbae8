"""Eq. (13) from rendering: by hand, by loops, and what must hold of it whatever is seen."""

import itertools
import math

import pytest
import torch
from jaxtyping import TypeCheckError

from industnerf.rendering.torch_renderer import confidence_reference
from tests.rendering.loops import Sample, confidence_loops, march_rays
from tests.rendering.point_grids import f64, point_grid
from tests.rendering.scenes import SCENES, RenderScene

READINGS = [
    {"transmittance": transmittance, "opacity": opacity, "samples": samples}
    for transmittance, opacity, samples in itertools.product(
        ["shared", "own"], ["without", "with"], ["max", "sum"]
    )
]
PRINTED = {"transmittance": "shared", "opacity": "without", "samples": "max"}
CORNER = f64(2, 2, 2)


def confidence_from_left(points, sigma, agreement=1.0, **settings):
    """Along the x axis, with samples at the middles of steps."""
    settings = {"k": 8, "weights": "inverse", "early_stop_transmittance": 0.0} | PRINTED | settings
    rays = f64([-2, 0, 0]), f64([1, 0, 0]), f64(0.5), -CORNER, CORNER
    return confidence_reference(*rays, points, sigma, f64(agreement), **settings)


@pytest.fixture(scope="module", params=SCENES)
def marched_scene(request) -> tuple[RenderScene, list[Sample]]:
    """A scene and what its rays meet."""
    scene = SCENES[request.param]
    return scene, list(march_rays(scene))


@pytest.mark.parametrize("reading", READINGS)
def test_loops_find_the_same(marched_scene, reading):
    scene, steps = marched_scene
    mine = confidence_reference(*scene.confidence_inputs, **scene.settings, **reading)
    truth = confidence_loops(scene, steps, **reading)
    # Sums of some hundred terms in another order.
    torch.testing.assert_close(mine, truth, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("transmittance", ["shared", "own"])
@pytest.mark.parametrize("opacity", ["without", "with"])
def test_one_sample_by_hand(transmittance, opacity):
    """At the origin, with points at 0.2 and 0.4 and one out of reach."""
    points, sigma = f64([0, 0.2, 0], [0, 0, 0.4], [0, 0.6, 0]), f64(0.3, 0.9, 5)
    readings = {"transmittance": transmittance, "opacity": opacity}
    result = confidence_from_left(points, sigma, agreement=0.5, step=4.0, radius=0.5, **readings)
    through = math.exp(-4 * (0.3 / 0.2 + 0.9 / 0.4) / (1 / 0.2 + 1 / 0.4))
    value = 0.5 * (through if transmittance == "own" else 1)
    value *= 1 - through if opacity == "with" else 1
    truth = f64(value, value * 0.2 / 0.4, 0)
    torch.testing.assert_close(result, truth, rtol=1e-14, atol=0)


def test_what_is_behind_a_plane_sees_less():
    """Planes at x = -1 and 1 of four samples each, as in the rendering of two planes."""
    sheet = point_grid((1, 1, 1), 1.0)
    points = torch.cat([sheet - f64(1, 0, 0), sheet + f64(1, 0, 0)])
    result = confidence_from_left(points, f64(1, 4), step=0.1, radius=0.2)
    torch.testing.assert_close(result, f64(1, math.exp(-1.0 * 4 * 0.1)), rtol=1e-14, atol=0)
    total = confidence_from_left(points, f64(1, 4), step=0.1, radius=0.2, samples="sum")
    truth = [sum(math.exp(-s * i * 0.1) for i in range(4)) for s in (1.0, 4.0)]
    truth[1] *= math.exp(-1.0 * 4 * 0.1)
    torch.testing.assert_close(total, f64(*truth), rtol=1e-14, atol=0)


def test_beyond_the_end_of_a_ray_nobody_is_seen():
    points, sigma = f64([-1, 0, 0], [1, 0, 0]), f64(100, 4)
    assert (confidence_from_left(points, sigma, step=0.1, radius=0.2) > 0).all()
    early = confidence_from_left(points, sigma, step=0.1, radius=0.2, early_stop_transmittance=1e-3)
    assert early.tolist() == [1, 0]


def test_a_point_without_alpha_is_not_seen_where_alpha_counts():
    """R15: a point of no density in front of the surface has full confidence as printed."""
    points, sigma = f64([-1, 0, 0], [1, 0, 0]), f64(0, 100)
    assert confidence_from_left(points, sigma, step=0.1, radius=0.2).tolist() == [1, 1]
    faint, dense = confidence_from_left(
        points, sigma, step=0.1, radius=0.2, opacity="with"
    ).tolist()
    assert faint == 0
    assert dense == pytest.approx(1 - math.exp(-100 * 0.1), rel=1e-14)


@pytest.mark.parametrize("name", SCENES)
def test_confidence_is_a_share(name):
    scene = SCENES[name]
    result = confidence_reference(*scene.confidence_inputs, **scene.settings, **PRINTED)
    assert (result >= 0).all()
    assert (result <= scene.agreement.max()).all()
    assert result.max() > 0


@pytest.mark.parametrize("samples", ["max", "sum"])
def test_rays_reduce_as_samples_do(samples):
    scene = SCENES["gappy"]
    reading = PRINTED | {"samples": samples} | scene.settings
    singly = zip(*(x.split(1) for x in (*scene.rays[:3], scene.agreement)), strict=True)
    rest = scene.lo, scene.hi, scene.points, scene.sigma
    parts = torch.stack(
        [confidence_reference(*ray, *rest, agreed, **reading) for *ray, agreed in singly]
    )
    full = confidence_reference(*scene.confidence_inputs, **reading)
    truth = parts.amax(dim=0) if samples == "max" else parts.sum(dim=0)
    torch.testing.assert_close(full, truth, rtol=1e-13, atol=0)  # the order of the sums


def test_agreement_scales_the_confidence():
    points, sigma = f64([-1, 0, 0], [1, 0.1, 0]), f64(1, 4)
    full = confidence_from_left(points, sigma, step=0.1, radius=0.2)
    half = confidence_from_left(points, sigma, agreement=0.5, step=0.1, radius=0.2)
    torch.testing.assert_close(half, full / 2, rtol=0, atol=0)  # halving is exact
    assert confidence_from_left(points, sigma, agreement=0.0, step=0.1, radius=0.2).tolist() == [
        0,
        0,
    ]


def test_no_cloud_has_no_confidence():
    nothing = torch.empty(0, 3).double()
    assert confidence_from_left(nothing, nothing[:, 0], step=0.1, radius=0.2).shape == (0,)


def test_an_unknown_reduction_is_refused():
    with pytest.raises(TypeCheckError):
        confidence_from_left(f64([0, 0, 0]), f64(1), step=0.1, radius=0.2, samples="mean")
