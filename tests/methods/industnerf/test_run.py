"""The whole method on solids that are known, in the frame and unit of their cameras."""

from dataclasses import replace
from functools import cache
from typing import get_args, get_type_hints

import numpy as np
import pytest
import torch

from industnerf.artifacts.renderings import Renderings
from industnerf.errors import ReconstructionFailed
from industnerf.methods.industnerf.rerender import rerender
from industnerf.methods.industnerf.run import Watch, Work, pictures, run
from industnerf.methods.industnerf.training import SWEEP
from industnerf.schema.readings import Readings
from tests.methods.industnerf.outcomes import SOLIDS, Recorder, bytes_of, errors
from tests.methods.industnerf.scenes import (
    CENTRE,
    REACH,
    cup,
    posed,
    settings,
)

SMALL = {"grid_res": 12, "rays": 256, "spacing": 0.08, "least_confidence": 0.01}
LEVELS = [{"steps": 6, "image_px": 32}, {"steps": 4, "image_px": 32}]
FREE = "industnerf_plus"


@pytest.mark.slow
@pytest.mark.parametrize("finer", [0, 1])
@pytest.mark.parametrize("name", SOLIDS)
def test_free_points_find_the_surface_and_its_colours(name, finer):
    learning, looking = {"steps": 120, "image_px": 64}, {"steps": 0}
    levels = [learning, *[looking] * finer]
    ways = settings(FREE, grid_res=32, rays=1024, levels=levels, spacing=0.03)
    away, covered, off = errors(SOLIDS[name], run(posed(SOLIDS[name], 40, 64), ways, 1))
    # A cell is 1.9 mm wide and a pixel 2 mm: the surface is found to a quarter of either.
    assert away < 0.5
    assert covered > 0.99
    # The texture climbs by 0.07 a mm at most, 0.045 in the mean; a guess of grey is off by 0.22.
    assert off < 0.03


@pytest.mark.slow
def test_a_pocket_is_opened_that_no_silhouette_shows():
    """The hull of the cup is a box: its lid, 10 mm up, is what has to go."""
    solid = cup()
    ways = settings(
        FREE, grid_res=32, rays=1024, levels=[{"steps": 300, "image_px": 64}], spacing=0.03
    )
    points = run(posed(solid, 40, 64), ways, 1).points - CENTRE
    inside = np.abs(points[:, :2]).max(axis=1) < 9  # three quarters of the pocket's width
    assert inside.sum() > 100
    assert (points[inside, 2] > 4).mean() < 0.05  # a lid is at 10, the floor at -6
    assert np.abs(solid.away(points)).mean() < 0.8


@pytest.mark.slow
@pytest.mark.parametrize("name", SOLIDS)
def test_the_papers_method_finds_the_surface(name):
    """It is not told the background, and has a hundredth of the steps that it would need."""
    level = {"image_px": 64, "points": 10_000}
    ways = settings(
        readings={"cloud": "confident"},
        network={"rate": 0.01},
        grid_res=16,
        rays=1024,
        levels=[level | {"steps": 150}, level | {"steps": 60}],
        least_confidence=0.05,
    )
    solid = SOLIDS[name]
    away, covered, off = errors(solid, run(posed(solid, 40, 64, None), ways, 1))
    # a cell of the first grid, 3.8 mm; points all over the ball of 30 mm would be 9 mm away
    assert away < 3.8
    assert covered > 0.9
    assert off < 0.11  # half of what grey is off by


ALTERNATIVES = [
    (name, value)
    for name, hint in get_type_hints(Readings).items()
    for value in get_args(hint)
    if name != "activation"  # of 10 steps a few leave nothing of the field
    and (name, value) != ("encoder", "shared")  # which, untaught, is frozen
]


@cache
def briefly(name: str, value: str) -> bytes:
    """What a few steps of the paper's method make of a ball with one reading chosen."""
    ways = settings(
        readings={"activation": "distance", name: value},
        warm_up={"steps": 6, "image_px": 32},
        levels=LEVELS,
        initial=0.0,
        **SMALL,
    )
    outcome = run(posed(SOLIDS["ball"], 8, 32, None), ways, 1)
    assert len(outcome.points)
    return bytes_of(outcome)


@pytest.mark.parametrize(("name", "value"), ALTERNATIVES)
def test_every_reading_reaches_the_cloud_from_the_warm_up_to_the_last_level(name, value):
    """It ends, and each choice ends elsewhere: one that nobody reads would change nothing."""
    others = [other for key, other in ALTERNATIVES if key == name and other != value]
    assert all(briefly(name, value) != briefly(name, other) for other in others)


METHODS = pytest.mark.parametrize("name", ["industnerf", FREE])


@pytest.mark.parametrize("name", ["industnerf_plus", "nerf"])
def test_points_of_a_grid_are_looked_up_not_searched(name):
    """On every level: else looking takes half as long again."""
    levels = [{"steps": 40, "image_px": 32}] * 2
    work = Work(
        posed(SOLIDS["ball"], 8, 32), settings(name, grid_res=20, levels=levels), 1, Watch()
    )
    while not work.finished:
        work.train()
        work.listen()
        assert work.training.points.cells.lattice


@METHODS
def test_same_seed_same_bytes_other_seed_other_bytes(name):
    given, ways = posed(SOLIDS["ball"], 6, 32), settings(name, **SMALL, levels=LEVELS)
    first = bytes_of(run(given, ways, 1))
    assert first == bytes_of(run(given, ways, 1))
    assert first != bytes_of(run(given, ways, 2))


@METHODS
def test_the_global_generator_is_left_alone(name):
    torch.manual_seed(5)
    before = torch.get_rng_state()
    run(posed(SOLIDS["ball"], 4, 32), settings(name, **SMALL), 1)
    assert torch.equal(before, torch.get_rng_state())


def test_the_cloud_is_in_the_cameras_frame_and_unit():
    """Cameras moved and scaled move and scale the cloud; float32 of metres is a micrometre."""
    here = posed(SOLIDS["ball"], 6, 32)
    c2w = here.cameras.c2w.copy()
    c2w[:, :3, 3] = 3 * c2w[:, :3, 3] + 7
    there = replace(
        here,
        cameras=replace(here.cameras, c2w=c2w),
        centre=3 * here.centre + 7,
        radius=3 * here.radius,
    )
    ways = settings(FREE, **SMALL)
    a, b = (run(given, ways, 1) for given in (here, there))
    np.testing.assert_allclose(b.points, 3 * a.points + 7, rtol=0, atol=1e-4 * REACH)
    np.testing.assert_allclose(b.candidates, 3 * a.candidates + 7, rtol=0, atol=1e-4 * REACH)
    np.testing.assert_array_equal(a.colours, b.colours)
    taken = [o.pictures(g.cameras, o.background) for o, g in ((a, here), (b, there))]
    np.testing.assert_allclose(taken[1].depth_mm, 3 * taken[0].depth_mm, rtol=1e-5)


def test_pictures_are_as_soft_as_learned_and_their_depth_is_of_the_hard_surface():
    """Aslant a soft surface is nearer than a hard one, so that outlines move when it hardens."""
    given = posed(SOLIDS["ball"], 12, 48)
    ways = settings(FREE, grid_res=16, rays=512, levels=[{"steps": 60, "image_px": 48}])
    work = Work(given, ways, 1, Watch())
    work.train()
    work.listen()
    eyes, behind, last = work.scene.eyes, work.scene.background, work.training
    taken = pictures(last, given, given.cameras, behind.numpy())

    def as_if(softness: float) -> Renderings:
        renderer = last.finely(softness)
        renderer.median_beta = renderer.beta
        return rerender(eyes, behind, renderer, *last.values(), given.radius)

    soft, hard = as_if(ways.softness.last), as_if(ways.softness.shown)
    off = [((t.rgb / 255 - given.rgb / 255) ** 2).mean() for t in (taken, hard)]
    assert off[0] < 0.7 * off[1]
    met = hard.depth_mm > 0
    np.testing.assert_array_equal(taken.depth_mm[met], hard.depth_mm[met])
    np.testing.assert_allclose(taken.depth_mm[~met], soft.depth_mm[~met], rtol=1e-5)
    assert (taken.depth_mm[~met] > 0).any()


@METHODS
def test_a_watch_is_told_how_it_goes_and_changes_nothing(name):
    given, ways = posed(SOLIDS["ball"], 6, 32), settings(name, **SMALL, levels=LEVELS)
    watch = Recorder()
    outcome = run(given, ways, 1, watch)
    assert watch.begun == [("level 0", 6), ("level 1", 4)]
    assert outcome.first_steps == {"level 0": 0, "level 1": 6}
    assert watch.losses == outcome.losses
    assert outcome.steps == len(watch.seen) == 10
    # while E learns a run goes on only from where all views are told by it as it is
    assert len(watch.states) == (2 if name == "industnerf" else 10)
    for source, rendered in watch.seen:
        np.testing.assert_array_equal(source, given.rgb[0])
        assert rendered.shape == source.shape
    assert bytes_of(run(given, ways, 1)) == bytes_of(outcome)


WAYS = {
    "free": (FREE, {}),
    "blind": ("industnerf", {"readings": {"encoder": "none"}}),
    "frozen": ("industnerf", {"readings": {"encoder": "frozen"}}),
}


@pytest.mark.parametrize("kind", WAYS)
def test_a_run_goes_on_from_any_state_to_the_same_bytes(kind):
    name, changes = WAYS[kind]
    given, ways = posed(SOLIDS["ball"], 4, 32), settings(name, **SMALL, levels=LEVELS, **changes)
    watch = Recorder()
    whole = bytes_of(run(given, ways, 1, watch))
    for step in (0, 5, 6, 9):  # the first, both sides of a change of level, the last
        rest = Recorder()
        assert bytes_of(run(given, ways, 1, rest, watch.states[step])) == whole
        assert len(rest.losses) == 9 - step
        assert rest.begun[0] == (("level 0", 5 - step) if step < 6 else ("level 1", 9 - step))


def test_a_trained_encoder_goes_on_to_the_same_bytes_from_where_it_may_stop():
    """Every SWEEP steps, and at the end: between, some views are told by an E of before."""
    given, ways = posed(SOLIDS["ball"], 6, 32), settings(**SMALL, levels=[{"steps": 45}])
    watch = Recorder()
    whole = run(given, ways, 1, watch)
    assert [state["training"]["taken"] for state in watch.states] == [SWEEP, 2 * SWEEP, 45]
    rest = run(given, ways, 1, None, watch.states[0])
    assert bytes_of(rest) == bytes_of(whole)


@pytest.mark.parametrize(
    ("name", "steps"), [("industnerf", 100), (FREE, 100), ("nerf", 100), ("nerf", 5)]
)
def test_photographs_of_nothing_fail(name, steps):
    given = posed(SOLIDS["ball"], 4, 32)
    blank = replace(given, rgb=np.full_like(given.rgb, 255))
    with pytest.raises(ReconstructionFailed, match=r"no point is left|the field is empty"):
        run(blank, settings(name, **SMALL, levels=[{"steps": steps}]), 1)


def test_a_pruned_network_stays_so_and_goes_on_from_any_state():
    given = posed(SOLIDS["ball"], 6, 32)
    sparse = settings(
        **SMALL, levels=LEVELS, readings={"encoder": "frozen"}, network={"pruned": 0.8}
    )
    dense = settings(**SMALL, levels=LEVELS, readings={"encoder": "frozen"})
    watch = Recorder()
    whole, plain = run(given, sparse, 1, watch), run(given, dense, 1)
    assert whole.losses[:6] == plain.losses[:6]  # it is pruned after the first level
    assert whole.losses[6:] != plain.losses[6:]
    assert whole.parameters < 0.3 * plain.parameters  # biases stay
    for step in (2, 8):
        rest = run(given, sparse, 1, None, watch.states[step])
        assert bytes_of(rest) == bytes_of(whole)
        assert rest.parameters == whole.parameters
