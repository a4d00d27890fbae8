"""More levels than ship, and each of them finer: coarse to fine is as long as it is configured."""

from itertools import pairwise
from math import sqrt

import pytest
from scipy.spatial import cKDTree

from industnerf.schema import IndustnerfSettings
from tests.methods.industnerf.results import (
    SOLIDS,
    RecordingCallback,
    errors,
    make_reconstructor,
    result_bytes,
    run,
)
from tests.methods.industnerf.synthetic_scenes import SCENE_RADIUS, make_posed_images, settings

RES, PX = 10, 48
CELL = 2 * SCENE_RADIUS / RES  # of the first grid, mm
LEVELS = [
    {"steps": 30, "image_px": PX},
    {"steps": 20, "image_px": PX, "points": 3000},
    {"steps": 20, "image_px": PX, "points": 4000},
]
STARTED_LEVELS = [("level 0", 30), ("level 1", 20), ("level 2", 20)]
# the method; how it refines; how far from an old point a new one is at most, in old spacings:
# anywhere in a cell that has one, or in the middle of an eighth of the old one's own cell
KINDS = {
    "drawn": ("industnerf", {}, sqrt(3)),
    "divided": ("industnerf", {"refine": "subdivide"}, sqrt(3) / 4),
}
every_kind = pytest.mark.parametrize("kind", KINDS)


def three_levels(kind: str, **changes) -> IndustnerfSettings:
    method, method_changes, _ = KINDS[kind]
    all_changes = (
        {"rays_per_step": 512, "surface_px": PX, "surface_spacing": 0.05} | method_changes | changes
    )
    return settings(
        method,
        **{"readings": {"density_activation": "sdf"}, "levels": LEVELS} | all_changes,
        grid_res=RES,
    )


@every_kind
def test_each_level_refines_the_last_and_the_last_has_the_surface(kind):
    """Within half a first cell, 3 mm: steps are few, and a surface still is 1 mm soft."""
    callback, levels = RecordingCallback(), []
    reconstructor = make_reconstructor(
        make_posed_images(SOLIDS["ball"], 24, PX), three_levels(kind), callback
    )
    while not reconstructor.is_finished:
        levels.append((reconstructor.trainer.points.positions, reconstructor.trainer.spacing))
        reconstructor.train()
        reconstructor.advance_level()
    assert callback.started_levels == STARTED_LEVELS
    assert len(levels) == 3
    for (old, spacing), (new, finer) in pairwise(levels):
        assert finer == spacing / 2 if kind != "drawn" else finer < 0.51 * spacing
        distances, _ = cKDTree(old.numpy()).query(new.numpy())
        assert distances.max() < 1.05 * KINDS[kind][2] * spacing
    result = reconstructor.result()
    assert result.level_starts == {"level 0": 0, "level 1": 30, "level 2": 50}
    distances, coverage, _ = errors(SOLIDS["ball"], result, CELL)
    assert distances < CELL / 2
    assert coverage > 0.99


def test_a_run_goes_on_from_any_of_three_levels_to_the_same_bytes():
    short_levels = [{"steps": 3, "image_px": 32}] * 3
    readings = {"density_activation": "sdf", "encoder": "frozen"}
    images = make_posed_images(SOLIDS["ball"], 4, 32)
    config = three_levels("divided", levels=short_levels, readings=readings)
    callback = RecordingCallback()
    complete = result_bytes(run(images, config, 1, callback))
    levels = [state["level"] for state in callback.states]
    assert levels == [0, 0, 0, 1, 1, 1, 2, 2, 2]
    for step in (1, 2, 3, 5, 6, 8):
        assert result_bytes(run(images, config, 1, None, callback.states[step])) == complete
