"""Polishing a surface whose pictures are rendered from a known one."""

from dataclasses import replace

import numpy as np
import pytest

from industnerf.config import load_params
from industnerf.geometry.cameras import Cameras, look_at, pinhole
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.methods.industnerf_plus.appearance import Appearance
from industnerf.methods.industnerf_plus.distance_grid import DistanceGrid, redistance
from industnerf.methods.industnerf_plus.finishes import FinishFit
from industnerf.methods.industnerf_plus.lighting import Lighting
from industnerf.methods.industnerf_plus.pictures import Pictures
from industnerf.methods.industnerf_plus.polish import Polisher
from industnerf.methods.industnerf_plus.rerender import render_views
from industnerf.methods.industnerf_plus.shaded_surface import PinholeRays, ShadedSurface
from industnerf.methods.industnerf_plus.surface_cloud import sample_visible_surface
from tests.methods.industnerf_plus import plugged_block

SIZE, PX, VIEWS = 44, 96, 14
CELL = 2 / SIZE
LO = np.full(3, CELL / 2 - 1)
NODES = np.stack(np.meshgrid(*[np.arange(float(SIZE))] * 3, indexing="ij"), axis=-1)
OFFSET = NODES - (SIZE - 1) / 2
CAMERAS = Cameras(
    np.repeat(pinhole(30.0, PX)[None], VIEWS, 0),
    look_at(4.1 * fibonacci_sphere(VIEWS), np.zeros(3)),
    PX,
    PX,
)
LIGHT = Lighting(0.2, np.array([[0.35, 0.1, 0.2], [-0.1, 0.3, -0.3]]))
SETTINGS = replace(
    load_params().method.industnerf_plus.polish, steps=60, rays_per_step=2048, light_pixels=4000
)
CELL_PX = CELL / 2 * (2 * CAMERAS.K[0, 0, 0] / 4.1)


def ball(radius: float = 14.0) -> np.ndarray:
    return np.linalg.norm(OFFSET, axis=-1) - radius


def make_surface(distance: np.ndarray, hull: np.ndarray | None = None) -> ShadedSurface:
    """Inside the hull of the ball's silhouettes, unless another is given."""
    hull = (ball(14.1) if hull is None else hull).astype(np.float32)
    distance = np.maximum(redistance(distance.astype(np.float32)), hull)
    return ShadedSurface(DistanceGrid(distance, hull, LO, CELL))


@pytest.fixture(scope="module")
def pictures() -> Pictures:
    """A ball in `LIGHT`, before white."""
    surface = make_surface(ball())
    surface.set_finishes(FinishFit(LIGHT, np.ones(1), np.zeros(0, np.int64), 0.0, 0.0))
    images = render_views(surface, np.zeros(3), 1.0, CAMERAS, np.ones((VIEWS, 3)))
    outline = np.where(images.depth_mm > 0, 9.0, -9.0).astype(np.float32)
    for view in outline:  # within two pixels of the outline pixels are not trusted
        edge = np.zeros(view.shape, bool)
        inside = view > 0
        for shift in (-2, -1, 1, 2):
            for axis in (0, 1):
                edge |= inside & ~np.roll(inside, shift, axis)
        view[edge] = 1.5
    return Pictures(images.rgb, np.ones((VIEWS, 3)), outline)


def polish(surface: ShadedSurface, pictures: Pictures, **changes) -> list[float]:
    rays = PinholeRays(CAMERAS, np.zeros(3), 1.0, surface.grid)
    settings = replace(SETTINGS, **changes)
    polisher = Polisher(surface, rays, pictures, CELL_PX, settings, 0)
    assert polisher.fit_light()
    return list(polisher.steps())


def error(surface: ShadedSurface) -> float:
    """Mean distance of the surface from the ball, in cells, by its nodes near zero."""
    distance = surface.distance.numpy()
    near = np.abs(distance) < 1
    return float(np.abs(distance - ball())[near].mean())


def test_the_light_of_the_pictures_is_found(pictures):
    surface = make_surface(ball())
    polish(surface, pictures, steps=0)
    normals = fibonacci_sphere(500)
    found = surface.finishes.lighting.brightness(normals)
    assert np.abs(found - LIGHT.brightness(normals)).mean() < 0.02
    assert surface.finishes.outlier_share < 0.02


def test_the_true_surface_stays_where_it_is(pictures):
    """It has the least loss: random pixels move it by a tenth of a cell."""
    surface = make_surface(ball())
    polish(surface, pictures, relax_rate=0.0)
    assert error(surface) < 0.12


def test_an_open_pocket_stays_open():
    """Its floor and walls are far from the hull, which cannot hold them: only the loss does."""
    truth = np.maximum(plugged_block.BLOCK, -plugged_block.POCKET)
    surface = plugged_block.surface_of(truth)
    rays = PinholeRays(plugged_block.VIEWS, np.zeros(3), 1.0, surface.grid)
    cell_px = surface.grid.spacing / 2 * (2 * plugged_block.VIEWS.K[0, 0, 0] / 4.0)
    pictures = plugged_block.photographs(truth)
    surface.finishes = None  # to be found anew
    polisher = Polisher(surface, rays, pictures, cell_px, replace(SETTINGS, steps=80), 0)
    assert polisher.fit_light()
    list(polisher.steps())
    exact, moved = redistance(truth.astype(np.float32)), surface.distance.numpy()
    inside = (np.abs(exact) < 1) & (surface.grid.hull < -1.5)
    drift = (moved - exact)[inside]
    assert abs(drift.mean()) < 0.1
    assert np.abs(drift).mean() < 0.2
    filled = (moved < 0) & (exact > 0) & (surface.grid.hull < -0.5)
    assert filled.sum() < 0.03 * ((exact > 0) & (surface.grid.hull < -0.5)).sum()


def test_ripples_are_smoothed_away(pictures):
    ripples = 0.6 - 0.6 * np.prod(np.sin(OFFSET * 0.9 + 0.3), axis=-1)
    surface = make_surface(ball() + ripples)
    before = error(surface)
    losses = polish(surface, pictures, relax_rate=0.0)
    assert error(surface) < 0.6 * before
    assert np.mean(losses[-10:]) < 0.5 * np.mean(losses[:5])


def test_a_flank_that_the_field_dug_out_is_filled(pictures):
    """Relaxation keeps what is carved from growing, and must not hold what is filled."""
    dent = 3.0 * np.exp(-((OFFSET - [0, 0, 14]) ** 2).sum(axis=-1) / (2 * 5.0**2))
    surface = make_surface(ball() + dent)
    polish(surface, pictures, steps=80)
    bottom = surface.distance.numpy()[21:23, 21:23, 35] - ball()[21:23, 21:23, 35]
    assert bottom.mean() < 0.8


def test_the_surface_never_leaves_the_hull(pictures):
    hull = ball(13.0)
    surface = make_surface(np.maximum(ball(), hull), hull)
    polish(surface, pictures)
    assert (surface.distance.numpy() >= surface.grid.hull - 1e-5).all()


def test_same_seed_same_bytes(pictures):
    first, second = make_surface(ball()), make_surface(ball())
    for surface in (first, second):
        polish(surface, pictures, steps=6)
    assert first.distance.numpy().tobytes() == second.distance.numpy().tobytes()


def test_the_cloud_is_even_seen_and_colored_as_the_pictures(pictures):
    surface = make_surface(ball())
    polish(surface, pictures, steps=0)
    rays = PinholeRays(CAMERAS, np.zeros(3), 1.0, surface.grid)
    appearance = Appearance(surface, rays, pictures)
    samples = sample_visible_surface(surface, rays, pictures, 4000, 0)
    offset = samples.points - (SIZE - 1) / 2
    assert np.abs(np.linalg.norm(offset, axis=1) - 14).mean() < 0.1
    assert np.abs(offset.mean(axis=0)).max() < 0.6  # area-uniform: 8 cells / sqrt(4000) is 0.13
    assert (samples.view >= 0).mean() > 0.99
    normals = offset / 14
    shown = samples.colors[:, 0] / 255
    facing = np.sort(normals @ fibonacci_sphere(VIEWS).T, axis=1)[:, -1] > 0.9
    assert np.abs(shown - LIGHT.brightness(normals))[facing].mean() < 0.02
    assert appearance.confidence(samples.points).mean() > 0.95
    albedo = appearance.albedo[tuple(np.rint(samples.points).astype(int).T)]
    assert np.abs(albedo - 1).mean() < 0.05


def test_enclosed_air_gives_no_points(pictures):
    hollow = np.maximum(ball(), 6.0 - np.linalg.norm(OFFSET, axis=-1))
    surface = make_surface(hollow)
    surface.update_band(0.3)
    rays = PinholeRays(CAMERAS, np.zeros(3), 1.0, surface.grid)
    samples = sample_visible_surface(surface, rays, pictures, 4000, 0)
    radius = np.linalg.norm(samples.points - (SIZE - 1) / 2, axis=1)
    assert (samples.view[radius < 10] == -1).all()
    assert (samples.view[radius > 10] >= 0).mean() > 0.99
