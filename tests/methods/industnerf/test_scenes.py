"""The helpers of these tests: what the caster photographs is what the solids say they are."""

import numpy as np
import pytest

from tests.methods.industnerf.scenes import CENTRE, REACH, around, ball, box, photographs, texture

SOLIDS = {"ball": ball(18.0), "box": box((16.0, 11.0, 8.0))}


@pytest.mark.parametrize("name", SOLIDS)
def test_rays_end_on_the_surface_and_come_from_outside(name):
    solid, rng = SOLIDS[name], np.random.default_rng(0)
    origins = rng.normal(size=(500, 3))
    origins *= 4 * REACH / np.linalg.norm(origins, axis=1, keepdims=True)
    aims = rng.uniform(-20, 20, (500, 3)) - origins
    directions = aims / np.linalg.norm(aims, axis=1, keepdims=True)
    t = solid.meets(origins, directions)
    hit = np.isfinite(t)
    assert 50 < hit.sum() < 450
    met = origins[hit] + t[hit, None] * directions[hit]
    np.testing.assert_allclose(solid.away(met), 0, atol=1e-9)
    # and nothing is met before that, nor at all by the others
    for share in np.linspace(0, 1, 50, endpoint=False):
        reach = share * np.where(hit, t, 8 * REACH)
        assert (solid.away(origins + reach[:, None] * directions) > -1e-9).all()


def test_the_middle_of_a_photograph_shows_the_point_that_faces_the_camera():
    cameras = around(6, 33)  # odd: a pixel looks along the axis
    middle = photographs(SOLIDS["ball"], cameras)[:, 16, 16]
    towards = (cameras.eyes - CENTRE) / np.linalg.norm(cameras.eyes - CENTRE, axis=1)[:, None]
    # a pixel spans 4.1 * 30 * 0.536 / 33 = 2 mm, over which the texture bends by 0.35 (1/5)^2 / 6
    truth = 255 * texture(18 * towards)
    np.testing.assert_allclose(middle, truth, atol=2)


def test_the_border_shows_the_background():
    seen = photographs(SOLIDS["box"], around(3, 24), behind=0.2)
    assert (seen[:, [0, -1]] == 51).all()
