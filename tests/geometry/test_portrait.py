"""The picture of solids whose every pixel is known."""

import numpy as np
import pytest

from industnerf.artifacts.part import Mesh
from industnerf.geometry.portrait import AMBIENT, LAMPS, MARGIN, TOWARDS_EYE, portrait
from tests.solids import ball, box, moved

SIZE = 64
GREY = 0.4


def picture(mesh: Mesh, albedo: float = GREY) -> np.ndarray:
    return portrait(mesh.vertices, mesh.faces, np.full((len(mesh.faces), 3), albedo), SIZE)


def lit(normal: np.ndarray) -> float:
    """Lambert's law, written out for one face."""
    back = TOWARDS_EYE / np.linalg.norm(TOWARDS_EYE)
    right = np.cross([0, 0, 1], back) / np.linalg.norm(np.cross([0, 0, 1], back))
    up = np.cross(back, right)
    light = AMBIENT
    for (x, y, z), intensity in LAMPS:
        lamp = (x * right + y * up + z * back) / np.linalg.norm([x, y, z])
        light += intensity * max(0.0, float(normal @ lamp))
    return light


def srgb(linear: float) -> int:
    return round(255 * (1.055 * linear ** (1 / 2.4) - 0.055))


def test_a_box_shows_its_three_nearer_sides_as_lambert_lights_them():
    seen = {tuple(pixel) for pixel in picture(box(20, 20, 20)).reshape(-1, 3).tolist()}
    for normal in np.array([[1.0, 0, 0], [0, -1, 0], [0, 0, 1]]):
        assert (srgb(GREY * lit(normal)),) * 3 in seen
    # Pixels on edges mix two of these or white, four rays each; nothing else is there.
    pure = {srgb(GREY * lit(n)) for n in np.array([[1.0, 0, 0], [0, -1, 0], [0, 0, 1]])} | {255}
    assert len(pure) == 4
    assert {value for value, _, _ in seen} >= pure


def test_a_ball_fills_the_picture_up_to_the_margin():
    covered = (picture(ball(10, 5)) < 255).any(axis=2)
    area = np.pi / 4 * (1 - 2 * MARGIN) ** 2
    # Pixels that the rim crosses count whole, half a pixel too much along all of it on average.
    rim = np.pi * (1 - 2 * MARGIN) / SIZE / 2
    assert covered.mean() == pytest.approx(area + rim, abs=rim)
    across = np.flatnonzero(covered.any(axis=0))
    assert across[0] == pytest.approx(MARGIN * SIZE, abs=1)
    assert across[-1] == pytest.approx((1 - MARGIN) * SIZE, abs=1)


def test_up_is_up_and_right_is_where_the_eye_has_it():
    """A rod along x, with a ball of another colour at its far end and one at its top."""
    parts = [box(2, 2, 40), moved(ball(4), by=(0, 0, 20)), moved(ball(4), by=(14, 12, -20))]
    colours = [(0.0, 0, 0), (1, 0, 0), (0, 0, 1)]
    vertices = np.concatenate([mesh.vertices for mesh in parts])
    starts = np.cumsum([0] + [len(mesh.vertices) for mesh in parts[:-1]])
    faces = np.concatenate([m.faces + s for m, s in zip(parts, starts, strict=True)])
    counts = [len(mesh.faces) for mesh in parts]
    shown = portrait(vertices, faces.astype(np.int32), np.repeat(colours, counts, axis=0), SIZE)
    red = np.argwhere((shown[..., 0] > 100) & (shown[..., 2] < 50)).mean(axis=0)
    blue = np.argwhere((shown[..., 2] > 100) & (shown[..., 0] < 50)).mean(axis=0)
    assert red[0] < SIZE / 3  # at the top
    assert blue[0] > SIZE / 2  # at the bottom
    assert blue[1] > red[1] + SIZE / 10  # and to the right


def test_an_inverted_face_is_lit_as_the_viewer_sees_it():
    mesh = box(20, 30, 40)
    inverted = Mesh.plain(mesh.vertices, np.ascontiguousarray(mesh.faces[:, ::-1]))
    np.testing.assert_array_equal(picture(inverted), picture(mesh))


def test_size_does_not_matter():
    mesh = moved(ball(10), by=(3, 4, 5))
    # A power of two changes no digit.
    np.testing.assert_array_equal(picture(moved(mesh, scale=1 / 1024)), picture(mesh))


def test_too_much_light_is_white():
    assert picture(ball(10), albedo=5.0).min() == 255


def test_what_has_no_extent_is_no_error():
    point = Mesh.plain(np.ones((3, 3)), np.array([[0, 1, 2]], np.int32))
    assert picture(point).shape == (SIZE, SIZE, 3)
    line = Mesh.plain(
        np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]), np.array([[0, 1, 2]], np.int32)
    )
    assert picture(line).shape == (SIZE, SIZE, 3)
