"""Shading like a photograph's: against the textbook, and within the light that there is."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.part import UNSPECIFIED, Appearance, Mesh
from industnerf.capture.light import Lights
from industnerf.capture.materials import Materials
from industnerf.capture.pbr_shading import (
    GLOW_SHARE,
    PbrShading,
    fresnel,
    ggx_specular,
    sky_reflectance,
)
from industnerf.capture.ray_hits import Surface
from industnerf.geometry.sphere import fibonacci_hemisphere, fibonacci_sphere

UP = np.array([0.0, 0, 1])
GOLD = Appearance("gold", (0.7, 0.5, 0.2), 1.0, 0.3)
RED = Appearance("red paint", (0.5, 0.1, 0.1), 0.0, 0.3)
BALL = trimesh.creation.icosphere(4, 10.0)
ALPHAS = [0.05, 0.1, 0.3, 0.6, 1.0]
TILTS = [0.0, 30.0, 60.0, 80.0]  # of the eye, degrees


def as_columns(vectors: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(np.atleast_2d(vectors).T, np.float32)


def view_direction(tilt_deg: float) -> np.ndarray:
    return np.array([np.sin(np.radians(tilt_deg)), 0, np.cos(np.radians(tilt_deg))])


def specular(light_dir: np.ndarray, view_dir: np.ndarray, f0: float, alpha: float) -> float:
    """What a lamp of intensity 1 is mirrored as by a face that looks up."""
    value = ggx_specular(
        light_dir.astype(np.float32),
        as_columns(view_dir),
        as_columns(UP),
        np.full((3, 1), f0, np.float32),
        np.full(1, alpha, np.float32),
    )
    return float(value[0, 0])


def specular_reference(
    light_dir: np.ndarray, view_dir: np.ndarray, f0: float, alpha: float
) -> float:
    """pi D F G / (4 n.v) in float64, term by term.

    D: Walter et al. (2007), eq. 33; G = 1 / (1 + L(l) + L(v)) with L of their eq. 34 as Heitz
    (2014), eq. 72 and 99; F: Schlick (1994), eq. 15.
    """
    half_vector = (light_dir + view_dir) / np.linalg.norm(light_dir + view_dir)
    tan2 = 1 / half_vector[2] ** 2 - 1
    d = alpha**2 / (np.pi * half_vector[2] ** 4 * (alpha**2 + tan2) ** 2)
    lambdas = [(np.sqrt(1 + alpha**2 * (1 / w[2] ** 2 - 1)) - 1) / 2 for w in (light_dir, view_dir)]
    f = f0 + (1 - f0) * (1 - half_vector @ view_dir) ** 5
    return np.pi * d * f / (1 + sum(lambdas)) / (4 * view_dir[2])


@pytest.mark.parametrize("alpha", ALPHAS)
def test_highlights_are_the_textbooks(alpha):
    for light_dir in fibonacci_hemisphere(30):
        for view_dir in fibonacci_hemisphere(7, 1.0)[:6]:
            truth = specular_reference(light_dir, view_dir, 0.3, alpha)
            # float32: 1e-7, and the slope's square is a difference of ones
            assert specular(light_dir, view_dir, 0.3, alpha) == pytest.approx(
                truth, rel=1e-3, abs=1e-5
            )


def test_straight_on_a_highlight_is_a_quarter_of_the_mirrored_light_over_its_width_squared():
    for alpha in ALPHAS:
        assert specular(UP, UP, 0.5, alpha) == pytest.approx(0.125 / alpha**2, rel=1e-4)


SKY = fibonacci_hemisphere(1000)


def reflected_sky(f0: float, roughness: float, albedo: float, tilt: float) -> float:
    """What a face sends back of a sky of radiance 1.

    A lamp of intensity i stands for the solid angle pi i of it: 1000 lamps of 2 / 1000 make the
    sky.
    """
    view_dir = view_direction(tilt)
    specular_values = np.array(
        [specular(light_dir, view_dir, f0, roughness**2) for light_dir in SKY]
    )
    entering = 1 - sky_reflectance_of(f0, roughness, SKY[:, 2])
    leaving = 1 - sky_reflectance_of(f0, roughness, view_dir[2])
    return float(2 * (specular_values + albedo * SKY[:, 2] * entering * leaving).mean())


def sky_reflectance_of(f0: float, roughness: float, cosine: np.ndarray | float) -> np.ndarray:
    f90 = max(1 - roughness, f0)
    return f0 + (f90 - f0) * (1 - cosine) ** 5


@pytest.mark.parametrize("tilt", TILTS)
@pytest.mark.parametrize("roughness", [0.5, 0.7, 1.0])
def test_no_face_sends_more_than_it_gets(roughness, tilt):
    """A perfect metal, and the whitest paint.  The sum over 1000 lamps is right to 1 %."""
    assert reflected_sky(1.0, roughness, 0.0, tilt) < 1.01
    assert reflected_sky(0.04, roughness, 1.0, tilt) < 1.01


def test_what_the_dullest_metal_sends_straight_up_is_known():
    """Of width 1 D is 1 / pi and G is 2 c / (1 + c): the integral of c / (1 + c) is 1 - ln 2."""
    assert reflected_sky(1.0, 1.0, 0.0, 0.0) == pytest.approx(1 - np.log(2), rel=1e-3)


def test_a_smooth_perfect_metal_sends_nearly_all_of_it():
    """What is missing is what the grooves send to each other, which the formula leaves out."""
    assert reflected_sky(1.0, 0.5, 0.0, 0.0) > 0.9


def test_what_is_mirrored_of_the_sky_and_what_is_not_make_one_at_most():
    for roughness in (0.0, 0.3, 1.0):
        for f0 in (0.04, 0.5, 1.0):
            n_dot_v = np.linspace(0.01, 1, 50, dtype=np.float32)
            m, r = np.full((3, 50), f0, np.float32), np.full(50, roughness, np.float32)
            total = sky_reflectance(m, r, n_dot_v) + (1 - fresnel(m, n_dot_v))
            assert (sky_reflectance(m, r, n_dot_v) >= m - 1e-6).all()
            assert (total <= 1 + 1e-6).all()


# --- on parts --------------------------------------------------------------------------------


def pbr_of(
    solid: trimesh.Trimesh, appearance: Appearance, light, settings
) -> tuple[Surface, PbrShading]:
    mesh = Mesh.with_one_appearance(
        np.array(solid.vertices, float), np.array(solid.faces, np.int32)
    )
    surface = Surface(mesh, 30.0)
    return surface, PbrShading(
        surface,
        Materials.from_mesh(mesh, [appearance], [0.6] * 3),
        Lights.from_params(light),
        settings,
    )


@pytest.fixture
def one_light(shipped):
    return replace(shipped.light, ambient=0.0, directions=[[0.0, 0.0, 1.0]], intensities=[1.0])


@pytest.fixture
def point_light(shipped):
    return replace(shipped.photorealistic, light_half_angle_deg=0.0, shadow_samples=1)


def radiance_at(
    surface: Surface, shade: PbrShading, camera_center: np.ndarray, positions: np.ndarray
) -> np.ndarray:
    return shade(
        surface.intersect(
            camera_center, (np.atleast_2d(positions) - camera_center).astype(np.float32)
        )
    )


@pytest.mark.parametrize("appearance", [GOLD, RED])
def test_a_ball_under_one_lamp_is_half_lit(one_light, point_light, appearance):
    surface, shade = pbr_of(BALL, appearance, one_light, point_light)
    camera_center, rng = np.array([100.0, 0, 0]), np.random.default_rng(0)
    at = np.stack([np.zeros(4000), *rng.uniform(-9, 9, (2, 4000))], axis=1)
    hits = surface.intersect(camera_center, (at - camera_center).astype(np.float32))
    light = shade(hits)
    height = hits.normal[2] / np.linalg.norm(hits.normal, axis=0)
    assert (light[:, height < 0] == 0).all()
    assert (light[0, height > 0.05] > 0).all()
    # half of the picture of a ball lit from above is dark; 4000 points know it to 0.8 %
    assert (light[0] == 0).mean() == pytest.approx(0.5, abs=0.04)


def test_paint_under_one_lamp_is_paint_and_its_highlight(one_light, point_light):
    """From 45 degrees aside: Lambert, less what is mirrored, plus the textbook's highlight."""
    surface, shade = pbr_of(trimesh.creation.box((20, 20, 20)), RED, one_light, point_light)
    camera_center = view_direction(45.0)
    radiance = radiance_at(surface, shade, 10 * UP + 200 * camera_center, 10 * UP)[:, 0]
    rest = (1 - 0.04) * (1 - sky_reflectance_of(0.04, 0.3, camera_center[2]))
    specular_value = specular_reference(UP, camera_center, 0.04, 0.3**2)
    # the wall behind the lamp, as seen in the mirror, by the sky's rule
    wall = camera_center[2] * sky_reflectance_of(0.04, 0.3, camera_center[2])
    expected = np.array(RED.albedo) * rest + (1 - GLOW_SHARE) * specular_value + GLOW_SHARE * wall
    np.testing.assert_allclose(radiance, expected, rtol=2e-3)


def test_metal_colors_what_it_mirrors_and_paint_does_not(one_light, point_light):
    box, camera_center = trimesh.creation.box((20, 20, 20)), np.array([0.0, 0, 200])
    reflected = {
        appearance.name: radiance_at(
            *pbr_of(box, appearance, one_light, point_light), camera_center, 10 * UP
        )[:, 0]
        for appearance in (GOLD, RED)
    }
    # straight on: (1/2) / (4 width^2) + 1/2 of the wall, times the albedo
    expected = np.array(GOLD.albedo) * (0.125 / 0.3**4 + 0.5)
    np.testing.assert_allclose(reflected["gold"], expected, rtol=1e-3)
    above = reflected["red paint"] - np.array(RED.albedo) * 0.96**2
    np.testing.assert_allclose(above, 0.04 * (0.125 / 0.3**4 + 0.5), rtol=1e-3)


def test_an_unstated_finish_is_dull_and_nearly_matte(shipped):
    """Its fields say: no metal, roughness 1.  What it mirrors is 4 % of the light, all over."""
    light = replace(shipped.light, ambient=0.0)
    photo = replace(shipped.photorealistic, light_half_angle_deg=0.0, shadow_samples=1)
    surface, shade = pbr_of(trimesh.creation.box((20, 20, 20)), UNSPECIFIED, light, photo)
    for up in np.vstack([np.eye(3), -np.eye(3)]):
        radiance = radiance_at(surface, shade, 200 * up, 10 * up)[:, 0]
        lights = Lights.from_params(light)
        lambertian = 0.6 * float(np.maximum(lights.directions @ up, 0) @ lights.intensity)
        # 0.96^2 of it enters and leaves; of each lamp at most 0.04 is mirrored, as far as it is up
        assert (radiance >= 0.96**2 * lambertian - 1e-6).all()
        assert (radiance <= (0.96**2 + 0.04 / 0.6) * lambertian + 1e-6).all()


def test_in_shadow_there_is_ambient_light_alone(shipped, point_light):
    """Under a table, seen from below its edge."""
    light = replace(shipped.light, directions=[[0.0, 0.0, 1.0]], intensities=[1.0])
    table = trimesh.util.concatenate(
        [
            trimesh.creation.box((40, 40, 2)),
            trimesh.creation.box((40, 40, 2)).apply_translation([0, 0, 30]),
        ]
    )
    camera_center = np.array([200.0, 0, 20])
    at = np.array([[5.0, 3, 1]])
    lit_radiance, shadowed_radiance = (
        radiance_at(
            *pbr_of(table, RED, replace(light, intensities=[i]), point_light), camera_center, at
        )
        for i in (1.0, 0.0)
    )
    np.testing.assert_array_equal(lit_radiance, shadowed_radiance)
    assert (shadowed_radiance > 0).all()
    on_top = radiance_at(*pbr_of(table, RED, light, point_light), np.array([200.0, 0, 90]), 31 * UP)
    assert on_top[0] > 2 * shadowed_radiance[0]  # of its own color


def test_metal_depends_on_the_view_and_a_dull_paint_hardly_does(shipped):
    ball = BALL.copy()
    camera_centers = 100 * fibonacci_sphere(40)
    point = np.array([[6.0, 6, 5.0]]) * 10 / np.linalg.norm([6, 6, 5.0])
    spread = {}
    for appearance in (GOLD, replace(GOLD, metallic=0.0, roughness=1.0)):
        surface, shade = pbr_of(ball, appearance, shipped.light, shipped.photorealistic)
        radiance = [
            radiance_at(surface, shade, camera_center, point)[0, 0]
            for camera_center in camera_centers
            if camera_center @ point[0] > 500
        ]
        spread[appearance.metallic] = np.ptp(radiance) / np.mean(radiance)
    assert spread[1.0] > 5 * spread[0.0]
    assert spread[0.0] < 0.2
