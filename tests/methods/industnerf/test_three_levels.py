"""More levels than ship, and each of them finer: coarse to fine is as long as it is configured."""

from itertools import pairwise
from math import sqrt

import pytest
from scipy.spatial import cKDTree

from industnerf.methods.industnerf.run import Work, run
from industnerf.schema import IndustnerfSettings
from tests.methods.industnerf.outcomes import SOLIDS, Recorder, bytes_of, errors
from tests.methods.industnerf.scenes import REACH, posed, settings

RES, PX = 10, 48
CELL = 2 * REACH / RES  # of the first grid, mm
LEVELS = [
    {"steps": 30, "image_px": PX},
    {"steps": 20, "image_px": PX, "points": 3000},
    {"steps": 20, "image_px": PX, "points": 4000},
]
BEGUN = [("level 0", 30), ("level 1", 20), ("level 2", 20)]
# the method; how it refines; how far from an old point a new one is at most, in old spacings:
# anywhere in a cell that has one, or in the middle of an eighth of the old one's own cell
KINDS = {
    "drawn": ("industnerf", {}, sqrt(3)),
    "divided": ("industnerf", {"refine": "divided"}, sqrt(3) / 4),
    "relief": ("industnerf_plus", {"grid_points": 0}, sqrt(3) / 4),
}
every_kind = pytest.mark.parametrize("kind", KINDS)


def three_levels(kind: str, **changes) -> IndustnerfSettings:
    method, others, _ = KINDS[kind]
    more = {"rays": 512, "surface_px": PX, "spacing": 0.05} | others | changes
    return settings(
        method, **{"readings": {"activation": "distance"}, "levels": LEVELS} | more, grid_res=RES
    )


@every_kind
def test_each_level_refines_the_last_and_the_last_has_the_surface(kind):
    """Within half a first cell, 3 mm: steps are few, and a surface still is 1 mm soft."""
    watch, placed = Recorder(), []
    work = Work(posed(SOLIDS["ball"], 24, PX), three_levels(kind), 1, watch)
    while not work.finished:
        placed.append((work.training.points.positions, work.training.spacing))
        work.train()
        work.listen()
    assert watch.begun == BEGUN
    assert len(placed) == 3
    for (old, spacing), (new, finer) in pairwise(placed):
        assert finer == spacing / 2 if kind != "drawn" else finer < 0.51 * spacing
        away, _ = cKDTree(old.numpy()).query(new.numpy())
        assert away.max() < 1.05 * KINDS[kind][2] * spacing
    outcome = work.outcome()
    assert outcome.first_steps == {"level 0": 0, "level 1": 30, "level 2": 50}
    away, covered, _ = errors(SOLIDS["ball"], outcome, CELL)
    assert away < CELL / 2
    assert covered > 0.99


@pytest.mark.parametrize("kind", ["divided", "relief"])
def test_a_run_goes_on_from_any_of_three_levels_to_the_same_bytes(kind):
    few = [{"steps": 3, "image_px": 32}] * 3
    readings = {"activation": "distance", "encoder": "frozen"}
    given, ways = posed(SOLIDS["ball"], 4, 32), three_levels(kind, levels=few, readings=readings)
    watch = Recorder()
    whole = bytes_of(run(given, ways, 1, watch))
    levels = [state["level"] for state in watch.states]
    assert levels == [0, 0, 0, 1, 1, 1, 2, 2, 2]
    for step in (1, 2, 3, 5, 6, 8):
        assert bytes_of(run(given, ways, 1, None, watch.states[step])) == whole
