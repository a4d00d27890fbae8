"""Photographs of solids whose picture is known."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from industnerf.artifacts.finish import UNSTATED, Finish
from industnerf.artifacts.part import Mesh
from industnerf.artifacts.views import Frame
from industnerf.capture.chance import Draws
from industnerf.capture.develop import composed, develop, may_show, through_centres
from industnerf.capture.light import Lamps
from industnerf.capture.materials import Materials
from industnerf.capture.rigs import bounding_ball, cameras_around
from industnerf.capture.shading import Matte
from industnerf.capture.surface import Surface
from industnerf.geometry.cameras import (
    Cameras,
    back_projection,
    look_at,
    pinhole,
    pixel_centres,
    project,
    unproject,
)

RADIUS = 10.0  # mm, of the ball
BALL = trimesh.creation.icosphere(subdivisions=5, radius=RADIUS)
BOX = trimesh.creation.box((20, 30, 40))
RING = trimesh.creation.annulus(5, 10, 4, sections=64)


def matte(mesh, settings) -> Matte:
    return Matte(Materials.of(mesh, [UNSTATED], settings.albedo), Lamps.of(settings.light))


@pytest.fixture
def shoot(as_mesh):
    """Cameras around a solid, and the photograph from each, before white."""

    def photographs(solid, settings) -> tuple[Cameras, list[Frame]]:
        mesh = solid if isinstance(solid, Mesh) else as_mesh(solid)
        cameras, _ = cameras_around(*bounding_ball(mesh.vertices), settings)
        surface, shade = Surface(mesh, settings.crease_deg), matte(mesh, settings)
        shots = zip(cameras.K, cameras.c2w, strict=True)
        plain = np.ones(3), settings, Draws(0, "part", "view")
        return cameras, [develop(surface, shade, K, c2w, *plain) for K, c2w in shots]

    return photographs


def ball_depth(radius: float, K: np.ndarray, c2w: np.ndarray, side: int) -> np.ndarray:
    """z of a ball at the origin at each pixel centre, inf where it is missed, in closed form."""
    rays = pixel_centres(side, side) @ np.linalg.inv(K)[:2, :2].T + np.linalg.inv(K)[:2, 2]
    rays = np.concatenate([rays, np.ones((len(rays), 1))], axis=1)
    centre = -c2w[:3, :3].T @ c2w[:3, 3]
    a, b, c = (rays**2).sum(1), rays @ centre, centre @ centre - radius**2
    root = np.sqrt(np.maximum(b**2 - a * c, 0))
    return np.where(b**2 >= a * c, (b - root) / a, np.inf).reshape(side, side)


def test_depth_of_a_ball_lies_between_those_of_its_in_and_circumscribed_balls(shoot, settings):
    facets = np.array(BALL.triangles)
    inner = np.einsum("ij,ij->i", facets[:, 0], np.array(BALL.face_normals)).min()
    assert 0.999 * RADIUS < inner < RADIUS
    cameras, frames = shoot(BALL, settings)
    slack = 1e-6 * 4 * RADIUS  # float32, four radii away
    for K, c2w, frame in zip(cameras.K, cameras.c2w, frames, strict=True):
        near = ball_depth(RADIUS + slack, K, c2w, settings.resolution)
        far = ball_depth(inner - slack, K, c2w, settings.resolution)
        assert frame.mask[np.isfinite(far)].all()
        assert not frame.mask[np.isinf(near)].any()
        assert (frame.depth_mm[frame.mask] >= near[frame.mask] - slack).all()
        both = np.isfinite(far)
        assert (frame.depth_mm[both] <= far[both] + slack).all()


def test_the_silhouette_of_a_ball_has_the_area_of_its_disc(shoot, settings):
    """The disc has radius f R / sqrt(d^2 - R^2); an image of it in pixels has its area to within
    about the square root of its circumference (independent pixels on the rim)."""
    settings = replace(settings, resolution=256, count=3, held_out=0)
    cameras, frames = shoot(BALL, settings)
    focal, distance = cameras.K[0, 0, 0], settings.radius * RADIUS
    radius_px = focal * RADIUS / np.sqrt(distance**2 - RADIUS**2)
    disc = np.linalg.norm(pixel_centres(256, 256) - 128, axis=1).reshape(256, 256) < radius_px
    for frame in frames:
        area = np.pi * radius_px**2
        assert frame.mask.sum() == pytest.approx(area, abs=3 * np.sqrt(2 * np.pi * radius_px))
        # facets lie within 0.1 % of the radius: a quarter of a pixel's width on the rim at most
        joined = (frame.mask | disc).sum()
        assert (frame.mask & disc).sum() / joined > 1 - 0.25 * 2 * np.pi * radius_px / area


def test_the_silhouette_of_a_box_is_the_hull_of_its_corners(shoot, settings):
    cameras, frames = shoot(BOX, settings)
    for K, c2w, frame in zip(cameras.K, cameras.c2w, frames, strict=True):
        hull = ConvexHull(project(np.array(BOX.vertices), K, c2w)[0])
        inside = pixel_centres(64, 64) @ hull.equations[:, :2].T + hull.equations[:, 2]
        beyond = inside.max(axis=1).reshape(64, 64)
        assert frame.mask[beyond < -1e-3].all()  # 1e-3 px: float32, see MARGIN_PX
        assert not frame.mask[beyond > 1e-3].any()


def test_depth_of_a_box_unprojects_onto_its_faces(shoot, settings):
    cameras, frames = shoot(BOX, settings)
    for K, c2w, frame in zip(cameras.K, cameras.c2w, frames, strict=True):
        uv, shown = pixel_centres(64, 64), frame.mask.ravel()
        depth = frame.depth_mm.ravel()[shown].astype(float)
        points = unproject(uv[shown], depth, K, c2w)
        off = (np.abs(points) - [10, 15, 20]).max(axis=1)  # 0 on the surface of the box
        # float32: 6e-8 of 110 mm, times the slope of the steepest face, some 20
        np.testing.assert_allclose(off, 0, rtol=0, atol=2e-4)


def test_colours_off_the_edges_are_those_of_three_faces_and_the_background(shoot, settings):
    light = settings.light
    lamps = np.array(light.directions) / np.linalg.norm(light.directions, axis=1, keepdims=True)
    normals = np.vstack([np.eye(3), -np.eye(3)])
    bright = light.ambient + np.maximum(normals @ lamps.T, 0) @ light.intensities
    colours = np.vstack([bright[:, None] * settings.albedo, [[1, 1, 1]]])
    known = {tuple(colour) for colour in np.rint(255 * colours).astype(int).tolist()}
    for frame in shoot(BOX, settings)[1]:
        found, count = np.unique(frame.rgb.reshape(-1, 3), axis=0, return_counts=True)
        pure = count[[tuple(colour) in known for colour in found.tolist()]].sum()
        # 9 visible edges of at most 45 px touch at most 2 px in each row or column they cross
        assert pure > 64**2 - 9 * 45 * 2
        assert pure > 0.9 * 64**2


@pytest.mark.parametrize("solid", [BOX, RING], ids=["box", "ring"])
def test_pixels_are_the_mean_of_a_picture_eight_times_as_fine(shoot, settings, solid):
    """The slow twin: all pixels, 64 centres in each, no choice of edges."""
    fine = replace(settings, resolution=8 * settings.resolution, edge_samples=1)
    for frame, twin in zip(shoot(solid, settings)[1], shoot(solid, fine)[1], strict=True):
        centres = np.where(twin.mask[..., None], twin.rgb, 255).astype(float)
        mean = centres.reshape(64, 8, 64, 8, 3).mean(axis=(1, 3))
        error = np.abs(frame.rgb - mean)
        # cover is right to 0.14 (see the test of edges), of a contrast of at most 255
        assert error.max() < 0.14 * 255
        # typically to 1/32, on the tenth of all pixels that are edges
        assert np.sqrt((error**2).mean()) < 255 / 32 * np.sqrt(0.1) * 1.5
        plain = np.abs(centres.reshape(64, 8, 64, 8, 3)[:, 4, :, 4] - mean)
        assert (error**2).mean() < 0.1 * (plain**2).mean()


def two_coloured_box() -> tuple[Mesh, Finish, Finish]:
    """The box with red towards +x, and blue elsewhere."""
    normals = np.array(BOX.face_normals)
    finish = np.where(normals[:, 0] > 0.5, 1, 0).astype(np.uint8)
    mesh = Mesh(np.array(BOX.vertices, float), np.array(BOX.faces, np.int32), finish)
    return mesh, Finish("blue", (0.1, 0.2, 0.8), 0.0, 1.0), Finish("red", (0.7, 0.2, 0.1), 0.0, 1.0)


def test_an_edge_between_two_finishes_is_the_mean_of_their_colours(settings):
    """The camera looks along the edge's bisector; the edge cuts the pixels of two columns' border.

    64 px are even, so the middle line u = 32 runs along the edge between columns 31 and 32; a
    principal point half a pixel to the right puts it through the middles of column 32.
    """
    mesh, *finishes = two_coloured_box()
    light = replace(settings.light, ambient=1.0, directions=[], intensities=[])
    eye = np.array([10.0, -15, 0]) + 100 * np.array([1, -1, 0])
    c2w = look_at(eye[None], np.array([10.0, -15, 0]))[0]
    K = pinhole(30.0, 64)
    K[0, 2] += 0.5
    shade = Matte(Materials.of(mesh, finishes, settings.albedo), Lamps.of(light))
    plain = np.ones(3), settings, Draws(0, "part", "view")
    rgb = develop(Surface(mesh, 30.0), shade, K, c2w, *plain).rgb[32]
    blue, red = (np.array(finish.albedo) for finish in finishes)
    # 8 bits round by half a level
    np.testing.assert_allclose(rgb[31], 255 * blue, rtol=0, atol=0.5 + 1e-4)
    np.testing.assert_allclose(rgb[33], 255 * red, rtol=0, atol=0.5 + 1e-4)
    # both faces are seen alike, so each covers half: 8 of 16 columns of samples
    np.testing.assert_allclose(rgb[32], 255 * (blue + red) / 2, rtol=0, atol=0.5 + 1e-4)


def test_three_channels_and_one_give_the_same_picture(shoot, settings):
    """Of a part of one colour; the edges are found by light in one, by radiance in the other."""
    mesh, _, red = two_coloured_box()
    twice = [red, replace(red, albedo=(0.7, 0.2, 0.1 + 1e-6))]
    cameras, plain = cameras_around(*bounding_ball(mesh.vertices), settings)[0], []
    for finishes in ([red, red], twice):
        shade = Matte(Materials.of(mesh, finishes, settings.albedo), Lamps.of(settings.light))
        assert len(shade.tint) == 3
        plain.append(
            develop(
                Surface(mesh, 30.0),
                shade,
                cameras.K[1],
                cameras.c2w[1],
                np.ones(3),
                settings,
                Draws(0, "part", "view"),
            ).rgb.astype(int)
        )
    # where only one of the two finds an edge it is fainter than 0.03, of which half is mixed in
    assert np.abs(plain[0] - plain[1]).max() <= 0.03 * 255


def test_mixing_on_edges_is_mixing_of_light():
    light, cover = (np.array([[value]], np.float32) for value in (0.3, 0.6))
    mixed = composed(light[None], cover, (0.5, 0.25, 1.0), np.array([1.0, 0.0, 0.5]))
    # channel by channel: albedo * light + background * (1 - cover), linear, in 255ths
    expected = 255 * np.array([0.15 + 0.4, 0.075, 0.3 + 0.2])
    np.testing.assert_allclose(np.ravel(list(mixed)), expected, rtol=1e-6)


def test_three_channels_are_mixed_each_with_its_own():
    light, cover = np.array([0.1, 0.2, 0.3], np.float32).reshape(3, 1, 1), np.full((1, 1), 0.5)
    mixed = composed(light, cover.astype(np.float32), (1.0, 1.0, 1.0), np.array([0, 0.2, 1.0]))
    expected = 255 * np.array([0.1, 0.2 + 0.1, 0.3 + 0.5])
    np.testing.assert_allclose(np.ravel(list(mixed)), expected, rtol=1e-6)


def test_rays_left_out_could_not_have_hit():
    """Every pixel centre in the hull of the points is kept, and few others are."""
    rng = np.random.default_rng(0)
    for scale in rng.uniform(1, 30, (20, 2)):
        points = 32 + scale * rng.normal(size=(30, 2))
        hull = ConvexHull(points)
        beyond = pixel_centres(64, 64) @ hull.equations[:, :2].T + hull.equations[:, 2]
        inside, kept = beyond.max(axis=1).reshape(64, 64) <= 0, may_show(points, 64)
        assert kept[inside].all()
        # at a corner of the hull, a polygon whose sides turn by 5.6 degrees at 11.25 between
        # supports reaches out by tan(5.6 degrees) of the neighbouring sides at most
        assert kept.sum() <= inside.sum() + 0.1 * 0.5 * hull.area**2 / 4 + 2 * hull.area + 4


def test_directions_go_through_pixel_centres_at_depth_one(settings):
    cameras, _ = cameras_around(np.zeros(3), 1.0, settings)
    K, c2w = cameras.K[1], cameras.c2w[1]
    rays = through_centres(back_projection(K, c2w).astype(np.float32), 64)
    uv, depth = project(c2w[:3, 3] + rays.astype(float), K, c2w)
    np.testing.assert_allclose(uv, pixel_centres(64, 64), rtol=0, atol=1e-4)  # float32 of 64 px
    np.testing.assert_allclose(depth, 1, rtol=0, atol=1e-6)
