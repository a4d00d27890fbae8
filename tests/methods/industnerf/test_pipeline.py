"""The whole method on solids that are known, in the frame and unit of their cameras."""

from dataclasses import replace
from functools import cache
from typing import get_args, get_type_hints

import numpy as np
import pytest
import torch

from industnerf.artifacts.renderings import Renderings
from industnerf.errors import ReconstructionFailed
from industnerf.methods.industnerf.pipeline import Callback
from industnerf.methods.industnerf.rerender import render_views, rerender
from industnerf.methods.industnerf.trainer import REFRESH_INTERVAL
from industnerf.schema.readings import Readings
from tests.methods.industnerf.results import (
    SOLIDS,
    RecordingCallback,
    errors,
    make_reconstructor,
    result_bytes,
    run,
)
from tests.methods.industnerf.synthetic_scenes import (
    CENTER,
    SCENE_RADIUS,
    cup,
    make_posed_images,
    settings,
)

SMALL = {"grid_res": 12, "rays_per_step": 256, "surface_spacing": 0.08, "min_confidence": 0.01}
LEVELS = [{"steps": 6, "image_px": 32}, {"steps": 4, "image_px": 32}]
PLUS = "industnerf_plus"
# signed distances have one level
LEVELS_OF = {"industnerf": LEVELS, PLUS: [{"steps": 10, "image_px": 32}], "nerf": LEVELS}


@pytest.mark.slow
@pytest.mark.parametrize("name", SOLIDS)
def test_free_points_find_the_surface_and_its_colors(name):
    levels = [{"steps": 120, "image_px": 64}]
    config = settings(PLUS, grid_res=32, rays_per_step=1024, levels=levels, surface_spacing=0.03)
    distance, coverage, color_error = errors(
        SOLIDS[name], run(make_posed_images(SOLIDS[name], 40, 64), config, 1)
    )
    # A cell is 1.9 mm wide and a pixel 2 mm: the surface is found to a quarter of either.
    assert distance < 0.5
    assert coverage > 0.99
    # The texture climbs by 0.07 a mm at most, 0.045 in the mean; a guess of gray is off by 0.22.
    assert color_error < 0.03


@pytest.mark.slow
def test_a_pocket_is_opened_that_no_silhouette_shows():
    """The hull of the cup is a box: its lid, 10 mm up, is what has to go."""
    solid = cup()
    config = settings(
        PLUS,
        grid_res=32,
        rays_per_step=1024,
        levels=[{"steps": 300, "image_px": 64}],
        surface_spacing=0.03,
    )
    points = run(make_posed_images(solid, 40, 64), config, 1).points - CENTER
    inside = np.abs(points[:, :2]).max(axis=1) < 9  # three quarters of the pocket's width
    assert inside.sum() > 100
    assert (points[inside, 2] > 4).mean() < 0.05  # a lid is at 10, the floor at -6
    assert np.abs(solid.signed_distance(points)).mean() < 0.8


@pytest.mark.slow
@pytest.mark.parametrize("name", SOLIDS)
def test_the_papers_method_finds_the_surface(name):
    """It is not told the background, and has a hundredth of the steps that it would need."""
    level = {"image_px": 64, "points": 10_000}
    config = settings(
        readings={"extraction": "confident_points"},
        network={"lr": 0.01},
        grid_res=16,
        rays_per_step=1024,
        levels=[level | {"steps": 150}, level | {"steps": 60}],
        min_confidence=0.05,
    )
    solid = SOLIDS[name]
    distance, coverage, color_error = errors(
        solid, run(make_posed_images(solid, 40, 64, None), config, 1)
    )
    # a cell of the first grid, 3.8 mm; points all over the ball of 30 mm would be 9 mm away
    assert distance < 3.8
    assert coverage > 0.9
    assert color_error < 0.11  # half of what gray is off by


ALTERNATIVES = [
    (name, value)
    for name, hint in get_type_hints(Readings).items()
    for value in get_args(hint)
    if name != "density_activation"  # of 10 steps a few leave nothing of the field
    and (name, value) != ("encoder", "pretrained")  # which, untaught, is frozen
]


@cache
def short_run(name: str, value: str) -> bytes:
    """What a few steps of the paper's method make of a ball with one reading chosen."""
    config = settings(
        readings={"density_activation": "sdf", name: value},
        warm_up={"steps": 6, "image_px": 32},
        levels=LEVELS,
        density_bias=0.0,
        **SMALL,
    )
    result = run(make_posed_images(SOLIDS["ball"], 8, 32, None), config, 1)
    assert len(result.points)
    return result_bytes(result)


@pytest.mark.parametrize(("name", "value"), ALTERNATIVES)
def test_every_reading_reaches_the_cloud_from_the_warm_up_to_the_last_level(name, value):
    """It ends, and each choice ends elsewhere: one that nobody reads would change nothing."""
    others = [other for key, other in ALTERNATIVES if key == name and other != value]
    assert all(short_run(name, value) != short_run(name, other) for other in others)


METHODS = pytest.mark.parametrize("name", ["industnerf", PLUS])


@pytest.mark.parametrize("name", ["industnerf_plus", "nerf"])
def test_points_of_a_grid_are_looked_up_not_searched(name):
    """On every level: else looking takes half as long again."""
    levels = [{"steps": 40, "image_px": 32}] * len(LEVELS_OF[name])
    images, config = (
        make_posed_images(SOLIDS["ball"], 8, 32),
        settings(name, grid_res=20, levels=levels),
    )
    reconstructor = make_reconstructor(images, config, Callback())
    while not reconstructor.is_finished:
        reconstructor.train()
        reconstructor.advance_level()
        assert reconstructor.trainer.points.cells.is_grid_aligned


@METHODS
def test_same_seed_same_bytes_other_seed_other_bytes(name):
    images = make_posed_images(SOLIDS["ball"], 6, 32)
    config = settings(name, **SMALL, levels=LEVELS_OF[name])
    first = result_bytes(run(images, config, 1))
    assert first == result_bytes(run(images, config, 1))
    assert first != result_bytes(run(images, config, 2))


@METHODS
def test_the_global_generator_is_left_alone(name):
    torch.manual_seed(5)
    before = torch.get_rng_state()
    run(make_posed_images(SOLIDS["ball"], 4, 32), settings(name, **SMALL), 1)
    assert torch.equal(before, torch.get_rng_state())


def test_the_cloud_is_in_the_cameras_frame_and_unit():
    """Cameras moved and scaled move and scale the cloud; float32 of meters is a micrometer."""
    original = make_posed_images(SOLIDS["ball"], 6, 32)
    c2w = original.cameras.c2w.copy()
    c2w[:, :3, 3] = 3 * c2w[:, :3, 3] + 7
    transformed = replace(
        original,
        cameras=replace(original.cameras, c2w=c2w),
        center=3 * original.center + 7,
        radius=3 * original.radius,
    )
    config = settings(PLUS, **SMALL)
    a, b = (run(images, config, 1) for images in (original, transformed))
    np.testing.assert_allclose(b.points, 3 * a.points + 7, rtol=0, atol=1e-4 * SCENE_RADIUS)
    np.testing.assert_allclose(b.candidates, 3 * a.candidates + 7, rtol=0, atol=1e-4 * SCENE_RADIUS)
    np.testing.assert_array_equal(a.colors, b.colors)
    renderings = [
        o.render_views(g.cameras, o.background) for o, g in ((a, original), (b, transformed))
    ]
    np.testing.assert_allclose(renderings[1].depth_mm, 3 * renderings[0].depth_mm, rtol=1e-5)


def test_pictures_are_as_soft_as_learned_and_their_depth_is_of_the_hard_surface():
    """Aslant a soft surface is nearer than a hard one, so that outlines move when it hardens."""
    images = make_posed_images(SOLIDS["ball"], 12, 48)
    config = settings(PLUS, grid_res=16, rays_per_step=512, levels=[{"steps": 60, "image_px": 48}])
    reconstructor = make_reconstructor(images, config, Callback())
    reconstructor.train()
    reconstructor.advance_level()
    cameras = reconstructor.scene.cameras
    background = reconstructor.scene.background
    trainer = reconstructor.trainer
    rendering = render_views(trainer, images, images.cameras, background.numpy())

    def render_with(beta: float) -> Renderings:
        renderer = trainer.fine_renderer(beta)
        renderer.median_beta = renderer.beta
        return rerender(cameras, background, renderer, *trainer.values(), images.radius)

    soft, hard = render_with(config.beta.end), render_with(config.beta.render)
    mse = [((t.rgb / 255 - images.rgb / 255) ** 2).mean() for t in (rendering, hard)]
    assert mse[0] < 0.7 * mse[1]
    is_hit = hard.depth_mm > 0
    np.testing.assert_array_equal(rendering.depth_mm[is_hit], hard.depth_mm[is_hit])
    np.testing.assert_allclose(rendering.depth_mm[~is_hit], soft.depth_mm[~is_hit], rtol=1e-5)
    assert (rendering.depth_mm[~is_hit] > 0).any()


@METHODS
def test_a_watch_is_told_how_it_goes_and_changes_nothing(name):
    images = make_posed_images(SOLIDS["ball"], 6, 32)
    config = settings(name, **SMALL, levels=LEVELS_OF[name])
    callback = RecordingCallback()
    result = run(images, config, 1, callback)
    steps = [level["steps"] for level in LEVELS_OF[name]]
    assert callback.started_levels == [(f"level {i}", count) for i, count in enumerate(steps)]
    assert result.level_starts == {f"level {i}": sum(steps[:i]) for i in range(len(steps))}
    assert callback.losses == result.losses
    assert result.steps == len(callback.previews) == 10
    # while E learns, at the first level, a run goes on only from where all views are told by it as
    # it is
    assert len(callback.states) == (1 + steps[1] if name == "industnerf" else 10)
    for source, rendered in callback.previews:
        np.testing.assert_array_equal(source, images.rgb[0])
        assert rendered.shape == source.shape
    assert result_bytes(run(images, config, 1)) == result_bytes(result)


METHOD_SETTINGS = {
    "free": ("nerf", {}),
    "blind": ("industnerf", {"readings": {"encoder": "none"}}),
    "frozen": ("industnerf", {"readings": {"encoder": "frozen"}, "view_weights_interval": 2}),
}


@pytest.mark.parametrize("kind", METHOD_SETTINGS)
def test_a_run_goes_on_from_any_state_to_the_same_bytes(kind):
    name, changes = METHOD_SETTINGS[kind]
    images = make_posed_images(SOLIDS["ball"], 4, 32)
    config = settings(name, **SMALL, levels=LEVELS_OF[name], **changes)
    callback = RecordingCallback()
    complete = result_bytes(run(images, config, 1, callback))
    for step in (0, 5, 6, 9):  # the first, both sides of a change of level, the last
        resumed = RecordingCallback()
        assert result_bytes(run(images, config, 1, resumed, callback.states[step])) == complete
        assert len(resumed.losses) == 9 - step
        assert resumed.started_levels[0] == (
            ("level 0", 5 - step) if step < 6 else ("level 1", 9 - step)
        )


def test_a_trained_encoder_goes_on_to_the_same_bytes_from_where_it_may_stop():
    """Every SWEEP steps, and at the end: between, some views are told by an E of before.

    At the last level E is kept, and all steps are such.
    """
    images = make_posed_images(SOLIDS["ball"], 6, 32)
    levels = [{"steps": 45}, {"steps": 3}]
    config = settings(**SMALL, levels=levels, view_weights_interval=2)
    callback = RecordingCallback()
    complete = run(images, config, 1, callback)
    assert [state["trainer"]["steps_done"] for state in callback.states] == [
        REFRESH_INTERVAL,
        2 * REFRESH_INTERVAL,
        45,
        *(1, 2, 3),
    ]
    for state in (callback.states[0], callback.states[4]):
        assert result_bytes(run(images, config, 1, None, state)) == result_bytes(complete)


@pytest.mark.parametrize(
    ("name", "steps"), [("industnerf", 100), (PLUS, 100), ("nerf", 100), ("nerf", 5)]
)
def test_photographs_of_nothing_fail(name, steps):
    images = make_posed_images(SOLIDS["ball"], 4, 32)
    blank = replace(images, rgb=np.full_like(images.rgb, 255))
    with pytest.raises(ReconstructionFailed, match=r"no point is left|the field is empty"):
        run(blank, settings(name, **SMALL, levels=[{"steps": steps}]), 1)


def test_a_pruned_network_stays_so_and_goes_on_from_any_state():
    images = make_posed_images(SOLIDS["ball"], 6, 32)
    sparse = settings(
        **SMALL, levels=LEVELS, readings={"encoder": "frozen"}, network={"prune_fraction": 0.8}
    )
    dense = settings(**SMALL, levels=LEVELS, readings={"encoder": "frozen"})
    callback = RecordingCallback()
    complete, unpruned = run(images, sparse, 1, callback), run(images, dense, 1)
    assert complete.losses[:6] == unpruned.losses[:6]  # it is pruned after the first level
    assert complete.losses[6:] != unpruned.losses[6:]
    assert complete.num_parameters < 0.3 * unpruned.num_parameters  # biases stay
    for step in (2, 8):
        resumed = run(images, sparse, 1, None, callback.states[step])
        assert result_bytes(resumed) == result_bytes(complete)
        assert resumed.num_parameters == complete.num_parameters
