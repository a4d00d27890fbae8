"""The helpers of these tests: what the caster photographs is what the solids say they are."""

import numpy as np
import pytest

from tests.methods.industnerf.synthetic_scenes import (
    CENTER,
    SCENE_RADIUS,
    ball,
    box,
    orbit_cameras,
    render_images,
    texture,
)

SOLIDS = {"ball": ball(18.0), "box": box((16.0, 11.0, 8.0))}


@pytest.mark.parametrize("name", SOLIDS)
def test_rays_end_on_the_surface_and_come_from_outside(name):
    solid, rng = SOLIDS[name], np.random.default_rng(0)
    origins = rng.normal(size=(500, 3))
    origins *= 4 * SCENE_RADIUS / np.linalg.norm(origins, axis=1, keepdims=True)
    offsets = rng.uniform(-20, 20, (500, 3)) - origins
    directions = offsets / np.linalg.norm(offsets, axis=1, keepdims=True)
    t = solid.hit_distance(origins, directions)
    hit = np.isfinite(t)
    assert 50 < hit.sum() < 450
    hits = origins[hit] + t[hit, None] * directions[hit]
    np.testing.assert_allclose(solid.signed_distance(hits), 0, atol=1e-9)
    # and nothing is met before that, nor at all by the others
    for share in np.linspace(0, 1, 50, endpoint=False):
        reach = share * np.where(hit, t, 8 * SCENE_RADIUS)
        assert (solid.signed_distance(origins + reach[:, None] * directions) > -1e-9).all()


def test_the_middle_of_a_photograph_shows_the_point_that_faces_the_camera():
    cameras = orbit_cameras(6, 33)  # odd: a pixel looks along the axis
    middle = render_images(SOLIDS["ball"], cameras)[:, 16, 16]
    directions = (cameras.centers - CENTER) / np.linalg.norm(cameras.centers - CENTER, axis=1)[
        :, None
    ]
    # a pixel spans 4.1 * 30 * 0.536 / 33 = 2 mm, over which the texture bends by 0.35 (1/5)^2 / 6
    expected = 255 * texture(18 * directions)
    np.testing.assert_allclose(middle, expected, atol=2)


def test_the_border_shows_the_background():
    images = render_images(SOLIDS["box"], orbit_cameras(3, 24), background=0.2)
    assert (images[:, [0, -1]] == 51).all()
