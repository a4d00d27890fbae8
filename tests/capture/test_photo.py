"""Shading like a photograph's: against the textbook, and within the light that there is."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.finish import UNSTATED, Finish
from industnerf.artifacts.part import Mesh
from industnerf.capture.light import Lamps
from industnerf.capture.materials import Materials
from industnerf.capture.photo import GLOW, Photo, fresnel, highlight, sheen
from industnerf.capture.surface import Surface
from industnerf.geometry.sphere import fibonacci_hemisphere, fibonacci_sphere

UP = np.array([0.0, 0, 1])
GOLD = Finish("gold", (0.7, 0.5, 0.2), 1.0, 0.3)
RED = Finish("red paint", (0.5, 0.1, 0.1), 0.0, 0.3)
BALL = trimesh.creation.icosphere(4, 10.0)
WIDTHS = [0.05, 0.1, 0.3, 0.6, 1.0]
TILTS = [0.0, 30.0, 60.0, 80.0]  # of the eye, degrees


def columns(vectors: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(np.atleast_2d(vectors).T, np.float32)


def eye_at(tilt_deg: float) -> np.ndarray:
    return np.array([np.sin(np.radians(tilt_deg)), 0, np.cos(np.radians(tilt_deg))])


def shone(towards: np.ndarray, eye: np.ndarray, mirrored: float, width: float) -> float:
    """What a lamp of intensity 1 is mirrored as by a face that looks up."""
    found = highlight(
        towards.astype(np.float32),
        columns(eye),
        columns(UP),
        np.full((3, 1), mirrored, np.float32),
        np.full(1, width, np.float32),
    )
    return float(found[0, 0])


def textbook(towards: np.ndarray, eye: np.ndarray, mirrored: float, width: float) -> float:
    """pi D F G / (4 n.v) in float64, term by term.

    D: Walter et al. (2007), eq. 33; G = 1 / (1 + L(l) + L(v)) with L of their eq. 34 as Heitz
    (2014), eq. 72 and 99; F: Schlick (1994), eq. 15.
    """
    half = (towards + eye) / np.linalg.norm(towards + eye)
    tan2 = 1 / half[2] ** 2 - 1
    d = width**2 / (np.pi * half[2] ** 4 * (width**2 + tan2) ** 2)
    slopes = [(np.sqrt(1 + width**2 * (1 / w[2] ** 2 - 1)) - 1) / 2 for w in (towards, eye)]
    f = mirrored + (1 - mirrored) * (1 - half @ eye) ** 5
    return np.pi * d * f / (1 + sum(slopes)) / (4 * eye[2])


@pytest.mark.parametrize("width", WIDTHS)
def test_highlights_are_the_textbooks(width):
    for towards in fibonacci_hemisphere(30):
        for eye in fibonacci_hemisphere(7, 1.0)[:6]:
            truth = textbook(towards, eye, 0.3, width)
            # float32: 1e-7, and the slope's square is a difference of ones
            assert shone(towards, eye, 0.3, width) == pytest.approx(truth, rel=1e-3, abs=1e-5)


def test_straight_on_a_highlight_is_a_quarter_of_the_mirrored_light_over_its_width_squared():
    for width in WIDTHS:
        assert shone(UP, UP, 0.5, width) == pytest.approx(0.125 / width**2, rel=1e-4)


SKY = fibonacci_hemisphere(1000)


def under_an_even_sky(mirrored: float, roughness: float, albedo: float, tilt: float) -> float:
    """What a face sends back of a sky of radiance 1.

    A lamp of intensity i stands for the solid angle pi i of it: 1000 lamps of 2 / 1000 make the
    sky.
    """
    eye = eye_at(tilt)
    gloss = np.array([shone(towards, eye, mirrored, roughness**2) for towards in SKY])
    entering = 1 - sheen_of(mirrored, roughness, SKY[:, 2])
    leaving = 1 - sheen_of(mirrored, roughness, eye[2])
    return float(2 * (gloss + albedo * SKY[:, 2] * entering * leaving).mean())


def sheen_of(mirrored: float, roughness: float, cosine: np.ndarray | float) -> np.ndarray:
    rim = max(1 - roughness, mirrored)
    return mirrored + (rim - mirrored) * (1 - cosine) ** 5


@pytest.mark.parametrize("tilt", TILTS)
@pytest.mark.parametrize("roughness", [0.5, 0.7, 1.0])
def test_no_face_sends_more_than_it_gets(roughness, tilt):
    """A perfect metal, and the whitest paint.  The sum over 1000 lamps is right to 1 %."""
    assert under_an_even_sky(1.0, roughness, 0.0, tilt) < 1.01
    assert under_an_even_sky(0.04, roughness, 1.0, tilt) < 1.01


def test_what_the_dullest_metal_sends_straight_up_is_known():
    """Of width 1 D is 1 / pi and G is 2 c / (1 + c): the integral of c / (1 + c) is 1 - ln 2."""
    assert under_an_even_sky(1.0, 1.0, 0.0, 0.0) == pytest.approx(1 - np.log(2), rel=1e-3)


def test_a_smooth_perfect_metal_sends_nearly_all_of_it():
    """What is missing is what the grooves send to each other, which the formula leaves out."""
    assert under_an_even_sky(1.0, 0.5, 0.0, 0.0) > 0.9


def test_what_is_mirrored_of_the_sky_and_what_is_not_make_one_at_most():
    for roughness in (0.0, 0.3, 1.0):
        for mirrored in (0.04, 0.5, 1.0):
            facing = np.linspace(0.01, 1, 50, dtype=np.float32)
            m, r = np.full((3, 50), mirrored, np.float32), np.full(50, roughness, np.float32)
            total = sheen(m, r, facing) + (1 - fresnel(m, facing))
            assert (sheen(m, r, facing) >= m - 1e-6).all()
            assert (total <= 1 + 1e-6).all()


# --- on parts --------------------------------------------------------------------------------


def photo_of(solid: trimesh.Trimesh, finish: Finish, light, photo) -> tuple[Surface, Photo]:
    mesh = Mesh.plain(np.array(solid.vertices, float), np.array(solid.faces, np.int32))
    surface = Surface(mesh, 30.0)
    return surface, Photo(surface, Materials.of(mesh, [finish], [0.6] * 3), Lamps.of(light), photo)


@pytest.fixture
def one_lamp(shipped):
    return replace(shipped.light, ambient=0.0, directions=[[0.0, 0.0, 1.0]], intensities=[1.0])


@pytest.fixture
def point_lamp(shipped):
    return replace(shipped.photo, lamp_deg=0.0, shadow_samples=1)


def seen_at(surface: Surface, shade: Photo, eye: np.ndarray, at: np.ndarray) -> np.ndarray:
    return shade(surface.look(eye, (np.atleast_2d(at) - eye).astype(np.float32)))


@pytest.mark.parametrize("finish", [GOLD, RED])
def test_a_ball_under_one_lamp_is_half_lit(one_lamp, point_lamp, finish):
    surface, shade = photo_of(BALL, finish, one_lamp, point_lamp)
    eye, rng = np.array([100.0, 0, 0]), np.random.default_rng(0)
    at = np.stack([np.zeros(4000), *rng.uniform(-9, 9, (2, 4000))], axis=1)
    spots = surface.look(eye, (at - eye).astype(np.float32))
    light = shade(spots)
    height = spots.normal[2] / np.linalg.norm(spots.normal, axis=0)
    assert (light[:, height < 0] == 0).all()
    assert (light[0, height > 0.05] > 0).all()
    # half of the picture of a ball lit from above is dark; 4000 points know it to 0.8 %
    assert (light[0] == 0).mean() == pytest.approx(0.5, abs=0.04)


def test_paint_under_one_lamp_is_paint_and_its_highlight(one_lamp, point_lamp):
    """From 45 degrees aside: Lambert, less what is mirrored, plus the textbook's highlight."""
    surface, shade = photo_of(trimesh.creation.box((20, 20, 20)), RED, one_lamp, point_lamp)
    eye = eye_at(45.0)
    found = seen_at(surface, shade, 10 * UP + 200 * eye, 10 * UP)[:, 0]
    rest = (1 - 0.04) * (1 - sheen_of(0.04, 0.3, eye[2]))
    gloss = textbook(UP, eye, 0.04, 0.3**2)
    # the wall behind the lamp, as seen in the mirror, by the sky's rule
    wall = eye[2] * sheen_of(0.04, 0.3, eye[2])
    expected = np.array(RED.albedo) * rest + (1 - GLOW) * gloss + GLOW * wall
    np.testing.assert_allclose(found, expected, rtol=2e-3)


def test_metal_colours_what_it_mirrors_and_paint_does_not(one_lamp, point_lamp):
    box, eye = trimesh.creation.box((20, 20, 20)), np.array([0.0, 0, 200])
    straight = {
        finish.name: seen_at(*photo_of(box, finish, one_lamp, point_lamp), eye, 10 * UP)[:, 0]
        for finish in (GOLD, RED)
    }
    # straight on: (1/2) / (4 width^2) + 1/2 of the wall, times the albedo
    expected = np.array(GOLD.albedo) * (0.125 / 0.3**4 + 0.5)
    np.testing.assert_allclose(straight["gold"], expected, rtol=1e-3)
    above = straight["red paint"] - np.array(RED.albedo) * 0.96**2
    np.testing.assert_allclose(above, 0.04 * (0.125 / 0.3**4 + 0.5), rtol=1e-3)


def test_an_unstated_finish_is_dull_and_nearly_matte(shipped):
    """Its fields say: no metal, roughness 1.  What it mirrors is 4 % of the light, all over."""
    light = replace(shipped.light, ambient=0.0)
    photo = replace(shipped.photo, lamp_deg=0.0, shadow_samples=1)
    surface, shade = photo_of(trimesh.creation.box((20, 20, 20)), UNSTATED, light, photo)
    for up in np.vstack([np.eye(3), -np.eye(3)]):
        found = seen_at(surface, shade, 200 * up, 10 * up)[:, 0]
        lamps = Lamps.of(light)
        matte = 0.6 * float(np.maximum(lamps.towards @ up, 0) @ lamps.intensity)
        # 0.96^2 of it enters and leaves; of each lamp at most 0.04 is mirrored, as far as it is up
        assert (found >= 0.96**2 * matte - 1e-6).all()
        assert (found <= (0.96**2 + 0.04 / 0.6) * matte + 1e-6).all()


def test_in_shadow_there_is_ambient_light_alone(shipped, point_lamp):
    """Under a table, seen from below its edge."""
    light = replace(shipped.light, directions=[[0.0, 0.0, 1.0]], intensities=[1.0])
    table = trimesh.util.concatenate(
        [
            trimesh.creation.box((40, 40, 2)),
            trimesh.creation.box((40, 40, 2)).apply_translation([0, 0, 30]),
        ]
    )
    eye = np.array([200.0, 0, 20])
    at = np.array([[5.0, 3, 1]])
    lit, dark = (
        seen_at(*photo_of(table, RED, replace(light, intensities=[i]), point_lamp), eye, at)
        for i in (1.0, 0.0)
    )
    np.testing.assert_array_equal(lit, dark)
    assert (dark > 0).all()
    on_top = seen_at(*photo_of(table, RED, light, point_lamp), np.array([200.0, 0, 90]), 31 * UP)
    assert on_top[0] > 2 * dark[0]  # of its own colour


def test_metal_depends_on_the_view_and_a_dull_paint_hardly_does(shipped):
    ball = BALL.copy()
    eyes = 100 * fibonacci_sphere(40)
    point = np.array([[6.0, 6, 5.0]]) * 10 / np.linalg.norm([6, 6, 5.0])
    spread = {}
    for finish in (GOLD, replace(GOLD, metallic=0.0, roughness=1.0)):
        surface, shade = photo_of(ball, finish, shipped.light, shipped.photo)
        seen = [seen_at(surface, shade, e, point)[0, 0] for e in eyes if e @ point[0] > 500]
        spread[finish.metallic] = np.ptp(seen) / np.mean(seen)
    assert spread[1.0] > 5 * spread[0.0]
    assert spread[0.0] < 0.2
