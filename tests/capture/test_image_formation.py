"""Photographs of solids whose picture is known."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from industnerf.artifacts.part import UNSPECIFIED, Appearance, Mesh
from industnerf.artifacts.views import RgbdImage
from industnerf.capture import image_formation
from industnerf.capture.image_formation import (
    bounding_window,
    candidate_pixels,
    composite,
    pixel_center_rays,
    render_image,
)
from industnerf.capture.light import Lights
from industnerf.capture.materials import Materials
from industnerf.capture.ray_hits import Surface
from industnerf.capture.render import view_shading
from industnerf.capture.rigs import bounding_ball, cameras_around
from industnerf.capture.rng import RandomStreams
from industnerf.capture.shading import LambertianShading
from industnerf.geometry.cameras import (
    Cameras,
    back_projection,
    look_at,
    pinhole,
    pixel_centers,
    project,
    unproject,
)
from industnerf.geometry.ray_packets import PacketHits
from industnerf.geometry.raycast import RaycastingScene

RADIUS = 10.0  # mm, of the ball
BALL = trimesh.creation.icosphere(subdivisions=5, radius=RADIUS)
BOX = trimesh.creation.box((20, 30, 40))
RING = trimesh.creation.annulus(5, 10, 4, sections=64)


def lambertian(mesh, settings) -> LambertianShading:
    return LambertianShading(
        Materials.from_mesh(mesh, [UNSPECIFIED], settings.albedo),
        Lights.from_params(settings.light),
    )


@pytest.fixture
def render_around(as_mesh):
    """Cameras around a solid, and the photograph from each, before white."""

    def render_all(solid, settings) -> tuple[Cameras, list[RgbdImage]]:
        mesh = solid if isinstance(solid, Mesh) else as_mesh(solid)
        cameras, _ = cameras_around(*bounding_ball(mesh.vertices), settings)
        ray_surface, shade = Surface(mesh, settings.crease_deg), lambertian(mesh, settings)
        poses = zip(cameras.K, cameras.c2w, strict=True)
        arguments = np.ones(3), settings, RandomStreams(0, "part", "view")
        return cameras, [render_image(ray_surface, shade, K, c2w, *arguments) for K, c2w in poses]

    return render_all


def ball_depth(radius: float, K: np.ndarray, c2w: np.ndarray, side: int) -> np.ndarray:
    """z of a ball at the origin at each pixel center, inf where it is missed, in closed form."""
    rays = pixel_centers(side, side) @ np.linalg.inv(K)[:2, :2].T + np.linalg.inv(K)[:2, 2]
    rays = np.concatenate([rays, np.ones((len(rays), 1))], axis=1)
    center = -c2w[:3, :3].T @ c2w[:3, 3]
    a, b, c = (rays**2).sum(1), rays @ center, center @ center - radius**2
    discriminant_root = np.sqrt(np.maximum(b**2 - a * c, 0))
    return np.where(b**2 >= a * c, (b - discriminant_root) / a, np.inf).reshape(side, side)


def test_depth_of_a_ball_lies_between_those_of_its_in_and_circumscribed_balls(
    render_around, settings
):
    facets = np.array(BALL.triangles)
    inner = np.einsum("ij,ij->i", facets[:, 0], np.array(BALL.face_normals)).min()
    assert 0.999 * RADIUS < inner < RADIUS
    cameras, images = render_around(BALL, settings)
    slack = 1e-6 * 4 * RADIUS  # float32, four radii away
    for K, c2w, image in zip(cameras.K, cameras.c2w, images, strict=True):
        near = ball_depth(RADIUS + slack, K, c2w, settings.resolution)
        far = ball_depth(inner - slack, K, c2w, settings.resolution)
        assert image.mask[np.isfinite(far)].all()
        assert not image.mask[np.isinf(near)].any()
        assert (image.depth_mm[image.mask] >= near[image.mask] - slack).all()
        both = np.isfinite(far)
        assert (image.depth_mm[both] <= far[both] + slack).all()


def test_the_silhouette_of_a_ball_has_the_area_of_its_disc(render_around, settings):
    """The disc has radius f R / sqrt(d^2 - R^2); an image of it in pixels has its area to within
    about the square root of its circumference (independent pixels on the rim)."""
    settings = replace(settings, resolution=256, count=3, held_out=0)
    cameras, images = render_around(BALL, settings)
    focal, distance = cameras.K[0, 0, 0], settings.radius * RADIUS
    radius_px = focal * RADIUS / np.sqrt(distance**2 - RADIUS**2)
    disc = np.linalg.norm(pixel_centers(256, 256) - 128, axis=1).reshape(256, 256) < radius_px
    for image in images:
        area = np.pi * radius_px**2
        assert image.mask.sum() == pytest.approx(area, abs=3 * np.sqrt(2 * np.pi * radius_px))
        # facets lie within 0.1 % of the radius: a quarter of a pixel's width on the rim at most
        joined = (image.mask | disc).sum()
        assert (image.mask & disc).sum() / joined > 1 - 0.25 * 2 * np.pi * radius_px / area


def test_the_silhouette_of_a_box_is_the_hull_of_its_corners(render_around, settings):
    cameras, images = render_around(BOX, settings)
    for K, c2w, image in zip(cameras.K, cameras.c2w, images, strict=True):
        hull = ConvexHull(project(np.array(BOX.vertices), K, c2w)[0])
        inside = pixel_centers(64, 64) @ hull.equations[:, :2].T + hull.equations[:, 2]
        beyond = inside.max(axis=1).reshape(64, 64)
        assert image.mask[beyond < -1e-3].all()  # 1e-3 px: float32, see MARGIN_PX
        assert not image.mask[beyond > 1e-3].any()


def test_depth_of_a_box_unprojects_onto_its_faces(render_around, settings):
    cameras, images = render_around(BOX, settings)
    for K, c2w, image in zip(cameras.K, cameras.c2w, images, strict=True):
        uv, is_foreground = pixel_centers(64, 64), image.mask.ravel()
        depth = image.depth_mm.ravel()[is_foreground].astype(float)
        points = unproject(uv[is_foreground], depth, K, c2w)
        off = (np.abs(points) - [10, 15, 20]).max(axis=1)  # 0 on the surface of the box
        # float32: 6e-8 of 110 mm, times the slope of the steepest face, some 20
        np.testing.assert_allclose(off, 0, rtol=0, atol=2e-4)


def test_colors_off_the_edges_are_those_of_three_faces_and_the_background(render_around, settings):
    light = settings.light
    light_directions = np.array(light.directions) / np.linalg.norm(
        light.directions, axis=1, keepdims=True
    )
    normals = np.vstack([np.eye(3), -np.eye(3)])
    bright = light.ambient + np.maximum(normals @ light_directions.T, 0) @ light.intensities
    colors = np.vstack([bright[:, None] * settings.albedo, [[1, 1, 1]]])
    expected_colors = {tuple(color) for color in np.rint(255 * colors).astype(int).tolist()}
    for image in render_around(BOX, settings)[1]:
        unique_colors, count = np.unique(image.rgb.reshape(-1, 3), axis=0, return_counts=True)
        pure = count[[tuple(color) in expected_colors for color in unique_colors.tolist()]].sum()
        # 9 visible edges of at most 45 px touch at most 2 px in each row or column they cross
        assert pure > 64**2 - 9 * 45 * 2
        assert pure > 0.9 * 64**2


@pytest.mark.parametrize("solid", [BOX, RING], ids=["box", "ring"])
def test_pixels_are_the_mean_of_a_picture_eight_times_as_fine(render_around, settings, solid):
    """The slow twin: all pixels, 64 centers in each, no choice of edges."""
    fine = replace(settings, resolution=8 * settings.resolution, edge_samples=1)
    for image, fine_image in zip(
        render_around(solid, settings)[1], render_around(solid, fine)[1], strict=True
    ):
        centers = np.where(fine_image.mask[..., None], fine_image.rgb, 255).astype(float)
        mean = centers.reshape(64, 8, 64, 8, 3).mean(axis=(1, 3))
        error = np.abs(image.rgb - mean)
        # cover is right to 0.14 (see the test of edges), of a contrast of at most 255
        assert error.max() < 0.14 * 255
        # typically to 1/32, on the tenth of all pixels that are edges
        assert np.sqrt((error**2).mean()) < 255 / 32 * np.sqrt(0.1) * 1.5
        arguments = np.abs(centers.reshape(64, 8, 64, 8, 3)[:, 4, :, 4] - mean)
        assert (error**2).mean() < 0.1 * (arguments**2).mean()


def two_colored_box() -> tuple[Mesh, Appearance, Appearance]:
    """The box with red towards +x, and blue elsewhere."""
    normals = np.array(BOX.face_normals)
    face_appearance = np.where(normals[:, 0] > 0.5, 1, 0).astype(np.uint8)
    mesh = Mesh(np.array(BOX.vertices, float), np.array(BOX.faces, np.int32), face_appearance)
    return (
        mesh,
        Appearance("blue", (0.1, 0.2, 0.8), 0.0, 1.0),
        Appearance("red", (0.7, 0.2, 0.1), 0.0, 1.0),
    )


def test_an_edge_between_two_finishes_is_the_mean_of_their_colors(settings):
    """The camera looks along the edge's bisector; the edge cuts the pixels of two columns' border.

    64 px are even, so the middle line u = 32 runs along the edge between columns 31 and 32; a
    principal point half a pixel to the right puts it through the middles of column 32.
    """
    mesh, *appearances = two_colored_box()
    light = replace(settings.light, ambient=1.0, directions=[], intensities=[])
    camera_center = np.array([10.0, -15, 0]) + 100 * np.array([1, -1, 0])
    c2w = look_at(camera_center[None], np.array([10.0, -15, 0]))[0]
    K = pinhole(30.0, 64)
    K[0, 2] += 0.5
    shade = LambertianShading(
        Materials.from_mesh(mesh, appearances, settings.albedo), Lights.from_params(light)
    )
    arguments = np.ones(3), settings, RandomStreams(0, "part", "view")
    rgb = render_image(Surface(mesh, 30.0), shade, K, c2w, *arguments).rgb[32]
    blue, red = (np.array(appearance.albedo) for appearance in appearances)
    # 8 bits round by half a level
    np.testing.assert_allclose(rgb[31], 255 * blue, rtol=0, atol=0.5 + 1e-4)
    np.testing.assert_allclose(rgb[33], 255 * red, rtol=0, atol=0.5 + 1e-4)
    # both faces are seen alike, so each covers half: 8 of 16 columns of samples
    np.testing.assert_allclose(rgb[32], 255 * (blue + red) / 2, rtol=0, atol=0.5 + 1e-4)


def test_three_channels_and_one_give_the_same_picture(render_around, settings):
    """Of a part of one color; the edges are found by light in one, by radiance in the other."""
    mesh, _, red = two_colored_box()
    twice = [red, replace(red, albedo=(0.7, 0.2, 0.1 + 1e-6))]
    cameras, arguments = cameras_around(*bounding_ball(mesh.vertices), settings)[0], []
    for appearances in ([red, red], twice):
        shade = LambertianShading(
            Materials.from_mesh(mesh, appearances, settings.albedo),
            Lights.from_params(settings.light),
        )
        assert len(shade.tint) == 3
        arguments.append(
            render_image(
                Surface(mesh, 30.0),
                shade,
                cameras.K[1],
                cameras.c2w[1],
                np.ones(3),
                settings,
                RandomStreams(0, "part", "view"),
            ).rgb.astype(int)
        )
    # where only one of the two finds an edge it is fainter than 0.03, of which half is mixed in
    assert np.abs(arguments[0] - arguments[1]).max() <= 0.03 * 255


def test_mixing_on_edges_is_mixing_of_light():
    light, coverage = (np.array([[value]], np.float32) for value in (0.3, 0.6))
    mixed = composite(light[None], coverage, (0.5, 0.25, 1.0), np.array([1.0, 0.0, 0.5]))
    # channel by channel: albedo * light + background * (1 - cover), linear, in 255ths
    expected = 255 * np.array([0.15 + 0.4, 0.075, 0.3 + 0.2])
    np.testing.assert_allclose(np.ravel(list(mixed)), expected, rtol=1e-6)


def test_three_channels_are_mixed_each_with_its_own():
    light, coverage = np.array([0.1, 0.2, 0.3], np.float32).reshape(3, 1, 1), np.full((1, 1), 0.5)
    mixed = composite(light, coverage.astype(np.float32), (1.0, 1.0, 1.0), np.array([0, 0.2, 1.0]))
    expected = 255 * np.array([0.1, 0.2 + 0.1, 0.3 + 0.5])
    np.testing.assert_allclose(np.ravel(list(mixed)), expected, rtol=1e-6)


def test_rays_left_out_could_not_have_hit():
    """Every pixel center in the hull of the points is kept, and few others are."""
    rng = np.random.default_rng(0)
    for scale in rng.uniform(1, 30, (20, 2)):
        points = 32 + scale * rng.normal(size=(30, 2))
        hull = ConvexHull(points)
        beyond = pixel_centers(64, 64) @ hull.equations[:, :2].T + hull.equations[:, 2]
        inside, candidates = beyond.max(axis=1).reshape(64, 64) <= 0, candidate_pixels(points, 64)
        assert candidates[inside].all()
        # at a corner of the hull, a polygon whose sides turn by 5.6 degrees at 11.25 between
        # supports reaches out by tan(5.6 degrees) of the neighboring sides at most
        assert candidates.sum() <= inside.sum() + 0.1 * 0.5 * hull.area**2 / 4 + 2 * hull.area + 4


def test_directions_go_through_pixel_centers_at_depth_one(settings):
    cameras, _ = cameras_around(np.zeros(3), 1.0, settings)
    K, c2w = cameras.K[1], cameras.c2w[1]
    rays = pixel_center_rays(back_projection(K, c2w).astype(np.float32), 64)
    uv, depth = project(c2w[:3, 3] + rays.astype(float), K, c2w)
    np.testing.assert_allclose(uv, pixel_centers(64, 64), rtol=0, atol=1e-4)  # float32 of 64 px
    np.testing.assert_allclose(depth, 1, rtol=0, atol=1e-6)


@pytest.mark.parametrize(("shading", "resolution"), [("matte", 193), ("photorealistic", 64)])
@pytest.mark.parametrize("solid", [BOX, BALL, RING], ids=["box", "ball", "ring"])
def test_packets_in_a_window_give_the_bytes_of_single_rays_everywhere(
    solid, shading, resolution, settings, as_mesh, monkeypatch
):
    """Two finishes, hence three channels; the slow twin casts every ray of the frame, alone."""
    mesh = as_mesh(solid)
    split = (np.arange(len(mesh.faces)) % 2).astype(np.uint8)
    mesh = Mesh(mesh.vertices, mesh.faces, split)
    settings = replace(settings, resolution=resolution, shading=shading)
    cameras, _ = cameras_around(*bounding_ball(mesh.vertices), settings)
    finishes = [UNSPECIFIED, Appearance("red", (0.8, 0.1, 0.1), 0.0, 0.3)]
    materials = Materials.from_mesh(mesh, finishes, settings.albedo)
    streams = RandomStreams(0, "part", "view")

    def render_all() -> list[RgbdImage]:
        surface = Surface(mesh, settings.crease_deg)
        shade = view_shading(surface, materials, settings, streams)
        background = np.array([0.2, 0.6, 1.0])
        return [
            render_image(surface, shade, K, c2w, background, settings, streams)
            for K, c2w in zip(cameras.K, cameras.c2w, strict=True)
        ]

    fast = render_all()
    monkeypatch.setattr(
        image_formation, "candidate_pixels", lambda points, side: np.ones((side, side), bool)
    )
    monkeypatch.setattr(RaycastingScene, "cast_from", single_rays)
    for image, slow_image in zip(fast, render_all(), strict=True):
        for plane, slow_plane in zip(vars(image).values(), vars(slow_image).values(), strict=True):
            assert plane.tobytes() == slow_plane.tobytes()


def single_rays(self: RaycastingScene, origin: np.ndarray, directions: np.ndarray) -> PacketHits:
    hits = self.cast(origin[None], directions)
    ray = np.flatnonzero(hits.face >= 0)
    return PacketHits(ray, hits.t[ray], hits.face[ray], hits.uv[ray])


def test_the_window_holds_the_part_and_its_neighbors():
    is_inside = np.zeros((8, 9), bool)
    is_inside[3, 4] = is_inside[5, 8] = True
    rows, columns = bounding_window(is_inside)
    assert range(8)[rows] == range(2, 7)
    assert range(9)[columns] == range(3, 9)
    assert is_inside[bounding_window(np.zeros((8, 9), bool))].size == 0
