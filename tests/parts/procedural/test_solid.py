"""Procedural solids: closed, of unit size, and the same whoever makes them."""

import json
import multiprocessing

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold

from industnerf.doctor.reproducible import DIGESTS, procedural_digest
from industnerf.errors import BadParams, BadPart
from industnerf.parts.catalogue.entries import read_catalogue
from industnerf.parts.procedural import (
    ALL_KINDS,
    DEFAULT_KINDS,
    RESEMBLING_KINDS,
    digest,
    procedural_solid,
    turned_kinds,
)
from industnerf.parts.procedural import solid as solid_module
from industnerf.parts.procedural.features import drilled
from industnerf.parts.procedural.kinds import KINDS
from industnerf.parts.procedural.primitives import block, union
from industnerf.parts.procedural.sampler import GRID, Sampler
from industnerf.parts.procedural.solid import (
    MAX_DRAWS,
    MAX_FACES,
    MIN_FACES,
    MIN_THICKNESS,
    MIN_VOLUME,
    _unit_mesh,
)
from industnerf.parts.validation import checks
from industnerf.seeds import generator

SOLIDS_A_KIND = 4


@pytest.fixture(scope="module")
def solids():
    return [procedural_solid(1, i, (kind,)) for kind in ALL_KINDS for i in range(SOLIDS_A_KIND)]


def test_every_solid_is_one_closed_piece_without_cavity(solids):
    for solid in solids:
        assert len(checks.bad_edges(solid.faces)) == 0, solid.kind
        assert checks.count_bodies(solid.faces) == 1, solid.kind
        assert len(np.unique(solid.faces)) == len(solid.vertices), solid.kind


def test_every_solid_fills_the_unit_cube_on_the_grid(solids):
    for solid in solids:
        low, high = solid.vertices.min(axis=0), solid.vertices.max(axis=0)
        np.testing.assert_array_equal(low, -high, err_msg=solid.kind)
        assert (high - low).max() == 1.0, solid.kind
        np.testing.assert_array_equal(solid.vertices / GRID % 1, 0, err_msg=solid.kind)


def test_every_solid_respects_the_limits(solids):
    for solid in solids:
        assert checks.extents_mm(solid.vertices).min() >= MIN_THICKNESS
        assert checks.volume_mm3(solid.vertices, solid.faces) >= MIN_VOLUME
        assert MIN_FACES <= len(solid.faces) <= MAX_FACES
        assert solid.vertices.dtype == np.float64
        assert solid.faces.dtype == np.int32
        assert all(0 <= level <= 1 for level in solid.albedo)


def test_a_mesh_has_the_volume_of_its_body():
    """Apart from the grid, to which each vertex moves by at most half of 2^-20 an axis."""
    size, hole = (1.0, 0.5, 0.25), (0.5, 0.25, 1.0)
    body = block(size) - block(hole)
    vertices, faces = _unit_mesh(body, np.eye(3))
    np.testing.assert_allclose(checks.volume_mm3(vertices, faces), body.volume(), rtol=1e-12)
    assert body.volume() == pytest.approx(1.0 * 0.5 * 0.25 - 0.5 * 0.25 * 0.25, rel=1e-12)


def test_the_largest_piece_is_kept():
    scattered = union([block((1, 1, 1)) - block((0.3, 0.3, 2)), block((0.4, 0.4, 0.4), (3, 0, 0))])
    vertices, faces = _unit_mesh(scattered, np.eye(3))
    assert checks.volume_mm3(vertices, faces) == pytest.approx(1 - 0.09, abs=4 * GRID)


def test_what_hangs_on_a_hair_is_dropped():
    """A bar thinner than the smallest detail vanishes, and the piece at its end with it."""
    big, small = block((1, 1, 1)) - block((0.3, 0.3, 2)), block((0.2, 0.2, 0.2), (1, 0, 0))
    hair = block((1, 5e-5, 5e-5), (0.5, 0, 0.1))
    _, faces = _unit_mesh(union([big, hair, small]), np.eye(3))
    assert checks.count_bodies(faces) == 1


@pytest.mark.parametrize(
    "draw",
    [
        Manifold,
        lambda: block((1, 1, 1)),  # 12 triangles
        lambda: block((1, 1, 0.019)) - block((0.5, 0.5, 1)),
        lambda: Manifold.sphere(1, 400),
        lambda: block((1, 0.021, 0.021)) - block((0.9, 0.015, 1)),
    ],
    ids=["empty", "plain", "thin", "fine", "little"],
)
def test_a_draw_that_teaches_nothing_is_refused(draw):
    assert _unit_mesh(draw(), np.eye(3)) is None


def test_a_refused_draw_is_drawn_anew_from_the_same_stream(monkeypatch):
    drawn = []

    def moody(rng):
        drawn.append(rng.uniform(0, 1))
        return (
            block((1, 1, drawn[-1])) - block((0.5, 0.5, 2)) if len(drawn) % 3 == 0 else Manifold()
        )

    monkeypatch.setitem(KINDS, "moody", moody)
    first, second = (procedural_solid(0, 0, ("moody",)) for _ in range(2))
    assert digest([first]) == digest([second])
    assert len(set(drawn)) == 3
    assert drawn[:3] == drawn[3:]


@pytest.mark.parametrize(
    "fail", [lambda rng: Manifold(), lambda rng: drilled(rng, Manifold(), 1, 0.1)]
)
def test_a_kind_that_never_succeeds_is_an_error(fail, monkeypatch):
    """Also one that goes on to drill what is not there."""
    monkeypatch.setitem(KINDS, "nothing", fail)
    with pytest.raises(BadPart, match=f"solid 3 of seed 2: {MAX_DRAWS} draws of nothing"):
        procedural_solid(2, 3, ("nothing",))


@pytest.mark.parametrize("seed", range(8))  # every form of its cuts
def test_nothing_is_cut_from_a_ring_that_its_fillet_consumes(seed, monkeypatch):
    """The tool would be unbounded, and manifold3d ends the process."""
    monkeypatch.setattr(turned_kinds, "fillet", lambda *_: CrossSection())
    assert turned_kinds.turned_ring(Sampler(generator(seed, "ring"))).is_empty()


def test_any_order_and_any_process_gives_the_same_bytes():
    indices = [7, 0, 3, 11]
    here = [digest([procedural_solid(5, i)]) for i in indices]
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        there = pool.map(_digest_of, sorted(indices))
    assert dict(zip(indices, here, strict=True)) == dict(zip(sorted(indices), there, strict=True))
    assert len(set(here)) == len(indices)


def _digest_of(index: int) -> str:
    return digest([procedural_solid(5, index)])


def test_another_seed_gives_other_solids():
    assert digest([procedural_solid(0, 0)]) != digest([procedural_solid(1, 0)])


def test_the_list_of_kinds_changes_nothing_but_the_kind():
    alone = procedural_solid(0, 5, ("gear",))
    among = next(
        solid
        for kinds in (("gear", "nut"), ("nut", "gear"))
        if (solid := procedural_solid(0, 5, kinds)).kind == "gear"
    )
    assert digest([alone]) == digest([among])


def test_all_kinds_are_drawn_and_none_much_more_often(monkeypatch):
    cube = block((1, 1, 1)) - block((0.5, 0.5, 2))
    for kind in ALL_KINDS:
        monkeypatch.setitem(KINDS, kind, lambda rng: cube)
    drawn = [procedural_solid(0, i, ALL_KINDS).kind for i in range(20 * len(ALL_KINDS))]
    counts = [drawn.count(kind) for kind in ALL_KINDS]
    assert min(counts) >= 5  # of 20, the standard deviation of a count is 4.4
    assert max(counts) <= 45


@pytest.mark.parametrize(("kinds", "named"), [(("gear", "goblet"), "goblet"), ((), "none")])
def test_unknown_kinds_are_named(kinds, named):
    with pytest.raises(BadParams, match=named):
        procedural_solid(0, 0, kinds)


def test_the_default_kinds_are_abstract_and_the_others_name_their_family(root):
    assert len(DEFAULT_KINDS) >= 20
    assert not set(DEFAULT_KINDS) & set(RESEMBLING_KINDS)
    families = {entry.family for entry in read_catalogue(root / "data/embedded")}
    assert set(RESEMBLING_KINDS.values()) == families


def test_solids_are_of_many_proportions(solids):
    extents = np.array([np.sort(checks.extents_mm(solid.vertices)) for solid in solids])
    fill = [
        checks.volume_mm3(solid.vertices, solid.faces) / checks.extents_mm(solid.vertices).prod()
        for solid in solids
    ]
    short, middle, _ = extents.T
    is_rod, is_plate, is_block = middle < 0.35, (short < 0.2) & (middle > 0.5), short > 0.5
    assert [share.mean() > 0.05 for share in (is_rod, is_plate, is_block)] == [True] * 3
    assert np.mean(np.array(fill) < 0.15) > 0.05  # sprawling
    assert np.mean(np.array(fill) > 0.6) > 0.05  # compact


def test_orientations_are_the_24_turns_of_a_cube():
    rng = solid_module.Sampler(np.random.default_rng(0))
    turns = [solid_module._orientation(rng) for _ in range(500)]
    assert all(np.linalg.det(turn) == pytest.approx(1) for turn in turns)
    assert len({turn.tobytes() for turn in turns + [t + 0.0 for t in turns]}) >= 24
    assert len({tuple((turn + 0.0).ravel()) for turn in turns}) == 24


def test_finishes_differ(solids):
    assert len({solid.albedo for solid in solids}) > 0.9 * len(solids)
    brightness = np.array([solid.albedo for solid in solids]).mean(axis=1)
    assert brightness.min() < 0.2
    assert brightness.max() > 0.6


def test_the_first_hundred_solids_are_the_published_ones(root):
    published = json.loads((root / DIGESTS).read_text(encoding="utf-8"))
    assert procedural_digest() == published["digests"]["procedural solids"]
