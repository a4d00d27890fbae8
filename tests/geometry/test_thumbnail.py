"""The picture of solids whose every pixel is known."""

import numpy as np
import pytest

from industnerf.artifacts.part import Mesh
from industnerf.geometry.thumbnail import AMBIENT, LIGHTS, MARGIN, TOWARDS_CAMERA, render_thumbnail
from tests.solids import ball, box, transform_mesh

SIZE = 64
GRAY = 0.4


def thumbnail(mesh: Mesh, albedo: float = GRAY) -> np.ndarray:
    return render_thumbnail(mesh.vertices, mesh.faces, np.full((len(mesh.faces), 3), albedo), SIZE)


def shaded(normal: np.ndarray) -> float:
    """Lambert's law, written out for one face."""
    back = TOWARDS_CAMERA / np.linalg.norm(TOWARDS_CAMERA)
    right = np.cross([0, 0, 1], back) / np.linalg.norm(np.cross([0, 0, 1], back))
    up = np.cross(back, right)
    light = AMBIENT
    for (x, y, z), intensity in LIGHTS:
        lamp = (x * right + y * up + z * back) / np.linalg.norm([x, y, z])
        light += intensity * max(0.0, float(normal @ lamp))
    return light


def srgb(linear: float) -> int:
    return round(255 * (1.055 * linear ** (1 / 2.4) - 0.055))


def test_a_box_shows_its_three_nearer_sides_as_lambert_lights_them():
    image = {tuple(pixel) for pixel in thumbnail(box(20, 20, 20)).reshape(-1, 3).tolist()}
    for normal in np.array([[1.0, 0, 0], [0, -1, 0], [0, 0, 1]]):
        assert (srgb(GRAY * shaded(normal)),) * 3 in image
    # Pixels on edges mix two of these or white, four rays each; nothing else is there.
    interior = {srgb(GRAY * shaded(n)) for n in np.array([[1.0, 0, 0], [0, -1, 0], [0, 0, 1]])} | {
        255
    }
    assert len(interior) == 4
    assert {value for value, _, _ in image} >= interior


def test_a_ball_fills_the_picture_up_to_the_margin():
    covered = (thumbnail(ball(10, 5)) < 255).any(axis=2)
    area = np.pi / 4 * (1 - 2 * MARGIN) ** 2
    # Pixels that the rim crosses count whole, half a pixel too much along all of it on average.
    rim = np.pi * (1 - 2 * MARGIN) / SIZE / 2
    assert covered.mean() == pytest.approx(area + rim, abs=rim)
    across = np.flatnonzero(covered.any(axis=0))
    assert across[0] == pytest.approx(MARGIN * SIZE, abs=1)
    assert across[-1] == pytest.approx((1 - MARGIN) * SIZE, abs=1)


def test_up_is_up_and_right_is_where_the_eye_has_it():
    """A rod along x, with a ball of another color at its far end and one at its top."""
    parts = [
        box(2, 2, 40),
        transform_mesh(ball(4), offset=(0, 0, 20)),
        transform_mesh(ball(4), offset=(14, 12, -20)),
    ]
    colors = [(0.0, 0, 0), (1, 0, 0), (0, 0, 1)]
    vertices = np.concatenate([mesh.vertices for mesh in parts])
    starts = np.cumsum([0] + [len(mesh.vertices) for mesh in parts[:-1]])
    faces = np.concatenate([m.faces + s for m, s in zip(parts, starts, strict=True)])
    counts = [len(mesh.faces) for mesh in parts]
    image = render_thumbnail(
        vertices, faces.astype(np.int32), np.repeat(colors, counts, axis=0), SIZE
    )
    red = np.argwhere((image[..., 0] > 100) & (image[..., 2] < 50)).mean(axis=0)
    blue = np.argwhere((image[..., 2] > 100) & (image[..., 0] < 50)).mean(axis=0)
    assert red[0] < SIZE / 3  # at the top
    assert blue[0] > SIZE / 2  # at the bottom
    assert blue[1] > red[1] + SIZE / 10  # and to the right


def test_an_inverted_face_is_lit_as_the_viewer_sees_it():
    mesh = box(20, 30, 40)
    inverted = Mesh.with_one_appearance(mesh.vertices, np.ascontiguousarray(mesh.faces[:, ::-1]))
    np.testing.assert_array_equal(thumbnail(inverted), thumbnail(mesh))


def test_size_does_not_matter():
    mesh = transform_mesh(ball(10), offset=(3, 4, 5))
    # A power of two changes no digit.
    np.testing.assert_array_equal(thumbnail(transform_mesh(mesh, scale=1 / 1024)), thumbnail(mesh))


def test_too_much_light_is_white():
    assert thumbnail(ball(10), albedo=5.0).min() == 255


def test_what_has_no_extent_is_no_error():
    point = Mesh.with_one_appearance(np.ones((3, 3)), np.array([[0, 1, 2]], np.int32))
    assert thumbnail(point).shape == (SIZE, SIZE, 3)
    line = Mesh.with_one_appearance(
        np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]), np.array([[0, 1, 2]], np.int32)
    )
    assert thumbnail(line).shape == (SIZE, SIZE, 3)
