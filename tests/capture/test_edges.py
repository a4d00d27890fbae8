"""Edges are found where they are, and pixels on them hold their mean."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from industnerf.capture.edges import BACKGROUND, edge_mask, hammersley_points, pixel_means

SIDE, FOCAL = 16, 30.0
V, U = (np.mgrid[:SIDE, :SIDE] + 0.5).astype(np.float32)
FLAT = np.full((1, SIDE, SIDE), 0.5, np.float32)  # one channel


def plane(tilt: float, depth: float = 100.0) -> np.ndarray:
    """Depth of a plane that falls back by `tilt` mm per mm to the right."""
    return (depth / (1 - tilt * (U - SIDE / 2) / FOCAL)).astype(np.float32)


@pytest.mark.parametrize("tilt", [0.0, 1.0, 3.5])
def test_a_plane_has_no_edge_however_steep(tilt):
    """At 3.5 its depth grows by a factor of 30 across the picture."""
    assert not edge_mask(plane(tilt), FLAT, FOCAL).any()


def test_a_silhouette_is_an_edge_on_both_sides():
    foreground = U < 6
    depth = np.where(foreground, plane(0.3), 0).astype(np.float32)
    edge = edge_mask(depth, np.where(foreground, FLAT, BACKGROUND), FOCAL)
    np.testing.assert_array_equal(edge, (U > 5) & (U < 7))


def test_a_crease_is_an_edge_on_both_sides():
    edge = edge_mask(plane(0.0), np.where(V < 4, FLAT, FLAT + np.float32(0.1)), FOCAL)
    np.testing.assert_array_equal(edge, (V > 3) & (V < 5))


@pytest.mark.parametrize(("pixels_deep", "is_edge"), [(10, True), (1, False)])
def test_a_step_between_equally_bright_planes_is_an_edge(pixels_deep, is_edge):
    """A pixel's side is 100 mm / 30 px at the depth of the plane."""
    depth = np.where(V < 8, plane(0.0), plane(0.0) + np.float32(pixels_deep * 100 / FOCAL))
    edge = edge_mask(depth.astype(np.float32), FLAT, FOCAL)
    np.testing.assert_array_equal(edge, (V > 7) & (V < 9) & is_edge)


def half_plane(normal: np.ndarray, offset: float, bright_level: float, dark: float):
    def light_at(uv: np.ndarray) -> np.ndarray:
        return np.where(uv @ normal < offset, bright_level, dark).astype(np.float32)[None]

    return light_at


def covered_area(pixel: np.ndarray, normal: np.ndarray, offset: float) -> float:
    """Share of a pixel on the near side of a line, by cutting it into 200 x 200."""
    beyond = (pixel + 0.5) @ normal - offset
    if abs(beyond) > np.sqrt(0.5):
        return float(beyond < 0)
    at = pixel + np.stack(np.mgrid[:200, :200], axis=-1).reshape(-1, 2)[:, ::-1] / 200 + 0.0025
    return float((at @ normal < offset).mean())


def pixel_means_of(light_at, samples: int):
    light = light_at(np.stack([U, V], axis=-1).reshape(-1, 2)).reshape(-1, SIDE, SIDE)
    edge = np.flatnonzero(edge_mask(plane(0.0), light, FOCAL))
    mean, coverage = pixel_means(light, edge, light_at, samples)
    return mean[0], coverage, edge


@given(st.floats(0, 2 * np.pi), st.floats(-3, 3))
def test_cover_of_a_straight_edge_is_the_area_that_it_cuts_off(angle, shift):
    """16 points, one in each of 16 columns, rows and 4 x 4 cells.

    A line crosses at most 7 of the cells.  Were each of those independently right on average,
    the error would have a deviation of sqrt(7 / 6) / 16 = 0.07; four pixels in ten thousand
    beyond twice that would be chance, but the points are more even than chance.
    A pixel of which less than 1/8 is cut off may pass for whole, where no corner is.
    """
    normal = np.array([np.cos(angle), np.sin(angle)])
    offset = float(normal @ [SIDE / 2, SIDE / 2]) + shift
    light, coverage, _ = pixel_means_of(half_plane(normal, offset, 0.5, BACKGROUND), 16)
    for v in range(SIDE):
        for u in range(SIDE):
            share = covered_area(np.array([u, v]), normal, offset)
            assert abs(coverage[v, u] - share) < 0.14
            assert light[v, u] == pytest.approx(0.5 * coverage[v, u], abs=1e-6)


@given(st.floats(0.01, 0.99))
def test_cover_of_an_edge_along_the_pixels_is_right_to_half_a_sample(share):
    for normal in (np.array([1.0, 0]), np.array([0, 1.0])):
        _, coverage, _ = pixel_means_of(half_plane(normal, 7 + share, 0.5, BACKGROUND), 16)
        row = coverage[3] if normal[0] else coverage[:, 3]
        assert row[7] == pytest.approx(share, abs=0.5 / 16 + 1e-6)
        assert (row[:7] == 1).all()
        assert (row[8:] == 0).all()


@given(st.floats(0, 2 * np.pi), st.floats(-3, 3))
def test_a_faint_edge_needs_no_further_points(angle, shift):
    """Corners and center alone: the five are wrong by at most 3/8 of the contrast.

    A line just past the center may cut off one corner only, of weight 1/8, and half the area.
    """
    normal = np.array([np.cos(angle), np.sin(angle)])
    offset = float(normal @ [SIDE / 2, SIDE / 2]) + shift
    requested: list[int] = []
    faint = half_plane(normal, offset, 0.6, 0.5)

    def light_at(uv: np.ndarray) -> np.ndarray:
        requested.append(len(uv))
        return faint(uv)

    light, coverage, edge = pixel_means_of(light_at, 16)
    assert requested[0] == SIDE**2
    assert requested[1] <= 4 * len(edge)
    assert requested[2] == 0
    assert (coverage == 1).all()
    for at in edge[:: max(len(edge) // 8, 1)]:
        share = covered_area(np.array([at % SIDE, at // SIDE]), normal, offset)
        assert light.flat[at] == pytest.approx(0.5 + 0.1 * share, abs=0.1 * 3 / 8 + 1e-3)


def test_a_change_of_color_is_an_edge_though_two_channels_stay():
    painted = np.tile(FLAT, (3, 1, 1))
    painted[1] += np.float32(0.1) * (U > 9)
    np.testing.assert_array_equal(edge_mask(plane(0.0), painted, FOCAL), (U > 8) & (U < 10))


def test_each_channel_has_its_own_mean():
    """What is left of 7.375 is (0.5, 0.1, 0.9), what is right of it (0.5, 0.2, 0.1)."""
    sides = np.array([[0.5, 0.5], [0.1, 0.2], [0.9, 0.1]], np.float32)

    def light_at(uv: np.ndarray) -> np.ndarray:
        return sides[:, (uv[:, 0] > 7.375).astype(int)]

    light = light_at(np.stack([U, V], axis=-1).reshape(-1, 2)).reshape(3, SIDE, SIDE)
    edge = np.flatnonzero(edge_mask(plane(0.0), light, FOCAL))
    mean, coverage = pixel_means(light, edge, light_at, 16)
    assert (coverage == 1).all()
    # 6 of column 7's 16 columns of samples are left of the border
    np.testing.assert_allclose(mean[:, 3, 7], sides @ [0.375, 0.625], rtol=0, atol=1e-6)
    np.testing.assert_array_equal(mean[:, 3, [6, 8]], sides)


def test_nothing_is_asked_twice_of_a_corner():
    requested: list[np.ndarray] = []

    def light_at(uv: np.ndarray) -> np.ndarray:
        requested.append(uv)
        return np.full((1, len(uv)), 0.5, np.float32)

    pixel_means(FLAT, np.arange(SIDE**2), light_at, 16)
    assert len(requested[0]) == len(np.unique(requested[0], axis=0)) == (SIDE + 1) ** 2


def test_without_edges_light_is_that_of_the_centers():
    light = np.where(U < 5, FLAT, BACKGROUND)
    mean, coverage = pixel_means(
        light, np.arange(0), lambda uv: np.zeros((1, len(uv)), np.float32), 16
    )
    np.testing.assert_array_equal(mean, np.where(U < 5, FLAT, 0))
    np.testing.assert_array_equal(coverage, U < 5)


@pytest.mark.parametrize("n", [1, 2, 4, 16, 64])
def test_samples_are_one_in_each_column_and_row(n):
    cells = np.sort(np.floor(hammersley_points(n) * n), axis=0)
    np.testing.assert_array_equal(cells, np.repeat(np.arange(n)[:, None], 2, axis=1))


def test_sixteen_samples_are_one_in_each_cell_of_a_grid():
    cells = np.floor(hammersley_points(16) * 4) @ [1, 4]
    np.testing.assert_array_equal(np.sort(cells), np.arange(16))


@pytest.mark.parametrize("n", [3, 5, 12])
def test_any_number_of_samples_will_do(n):
    points = hammersley_points(n)
    assert len(np.unique(points, axis=0)) == n
    assert (points > 0).all()
    assert (points < 1).all()
