"""Procedural solids as networks see them, against the stage that renders parts."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from industnerf.artifacts.part import save_part
from industnerf.capture.render import render_part
from industnerf.config import load_params
from industnerf.learning.procedural_shapes import load_procedural_shapes, resembled_families
from industnerf.learning.targets import contains_points, filled_shares
from industnerf.methods.base import NETWORK_INPUTS, Example
from industnerf.parts.procedural import DEFAULT_KINDS, RESEMBLING_KINDS, procedural_solid
from industnerf.procedural_dataset import CHUNK, EDGE_SAMPLES, KINDS, chunk_ranges, make_chunk
from industnerf.schema import ProceduralParams
from tests.samples import unit_part

SEED, PX = 3, 32
SETTINGS = ProceduralParams(solids=2, kinds="abstract", views=5, image_px=PX)


@pytest.fixture(scope="module")
def views():
    return replace(load_params(Path(__file__).parents[1] / "params.yaml").views, count=12)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, views):
    """Solids 0 and 1 in one chunk, and in chunks of their own."""
    target = tmp_path_factory.mktemp("procedural")
    for name, indices in (("both", range(2)), ("0", range(1)), ("1", range(1, 2))):
        (target / name).mkdir()
        make_chunk(target / name, indices=indices, seed=SEED, settings=SETTINGS, views=views)
    return target


@pytest.mark.parametrize("solids", [0, 1, CHUNK, 2 * CHUNK + 1])
def test_every_solid_is_in_one_chunk(solids):
    ranges = chunk_ranges(solids)
    assert [index for indices in ranges.values() for index in indices] == list(range(solids))
    assert list(ranges) == sorted(ranges)
    assert chunk_ranges(solids + 500) | ranges == chunk_ranges(solids + 500) or solids % CHUNK


def test_solids_are_the_same_bytes_in_any_chunk(folder):
    together = load_procedural_shapes(folder, ["both"])
    apart = load_procedural_shapes(folder, ["0", "1"])
    for one, other in zip(together, apart, strict=True):
        assert one.kind == other.kind
        for name, array in vars(one.arrays).items():
            assert array[one.row].tobytes() == getattr(other.arrays, name)[other.row].tobytes()


def rendered(solid, folder, views, **settings):
    """The solid as a part of the study, rendered by its stage."""
    mesh, finishes = solid.as_mesh(edge_mm=70.0)
    for name in ("part", "views"):
        (folder / name).mkdir()
    extents = tuple(float(edge) for edge in np.ptp(mesh.vertices, axis=0))
    save_part(folder / "part", unit_part(extents_mm=extents, finishes=finishes), mesh)
    render_part(folder / "part", folder / "views", replace(views, held_out=0, **settings), SEED)
    return Example("p", "p", folder / "part", folder / "views", NETWORK_INPUTS)


@pytest.mark.parametrize("index", [0, 1])
def test_a_solid_is_seen_as_a_part_of_its_shape_is(index, folder, views, tmp_path):
    shape = load_procedural_shapes(folder, ["both"])[index]
    solid = procedural_solid(SEED, index, DEFAULT_KINDS)
    part = rendered(solid, tmp_path, views, resolution=PX, edge_samples=EDGE_SAMPLES)
    assert shape.kind == solid.kind
    np.testing.assert_allclose(shape.background(5), part.background(5), rtol=0, atol=1e-6)
    # in float32, as is all that depends on mm
    np.testing.assert_allclose(shape.picture_frames(5), part.picture_frames(5), rtol=0, atol=1e-5)
    differs = np.abs(shape.rgb(PX, 5).astype(int) - part.rgb(PX, 5))
    # a ray that grazes an edge meets it in one unit and misses it in the other: one in 8 of a pixel
    assert (differs > 1).mean() < 0.002
    assert shape.rgb(PX, 5).std() > 10
    np.testing.assert_allclose(
        shape.filled_shares(), filled_shares(*part.mesh, 32), atol=0.02 * 255
    )


def test_small_pictures_are_the_large_ones_made_small(folder, views, tmp_path):
    """As parts are rendered, at 8 times the size; 8 rays of an edge are off by some levels."""
    shape = load_procedural_shapes(folder, ["both"])[0]
    solid = procedural_solid(SEED, 0, DEFAULT_KINDS)
    part = rendered(solid, tmp_path, views, resolution=8 * PX, edge_samples=4)
    differs = np.abs(shape.rgb(PX, 5).astype(int) - part.rgb(PX, 5))
    assert differs.mean() < 2
    # on borders between pixels that show the part and not, half a sample of 8 of all contrast
    assert np.quantile(differs, 0.99) < 0.2 * np.ptp(shape.rgb(PX, 5).astype(int))


def test_targets_are_those_of_the_solid(folder):
    for index, shape in enumerate(load_procedural_shapes(folder, ["both"])):
        solid = procedural_solid(SEED, index, DEFAULT_KINDS)
        pool = shape.occupancy_pool(1, np.random.default_rng(0))
        _, inside, _ = pool.draw(512, np.random.default_rng(0))
        points = pool.points.astype(float)
        truth = contains_points(solid.vertices, solid.faces, points)
        half = len(points) // 2
        # float16 moves points by 1e-4: of those near to a face some cross it
        assert truth[:half].mean() > 0.97
        assert truth[half:].mean() < 0.03
        assert inside.mean() == 0.5
        volume = shape.filled_shares().mean() / 255
        # 4 deviations of 16 384 draws
        assert pool.shares[0] * 1.1**3 == pytest.approx(volume, abs=0.012)
        surface = shape.surface_pool(np.random.default_rng(0))
        np.testing.assert_allclose(np.ptp(surface.astype(float), axis=0).max(), 1, atol=0.03)


def test_what_is_random_in_a_view_is_drawn_anew_for_every_solid(tmp_path, views, monkeypatch):
    """And solids of one kind are no exception."""
    monkeypatch.setitem(KINDS, "abstract", DEFAULT_KINDS[:1])
    settings, random = replace(SETTINGS, image_px=16), replace(views, background="random")
    made = []
    for seed in (SEED, SEED + 1):
        folder = tmp_path / str(seed)
        folder.mkdir()
        make_chunk(folder, indices=range(2), seed=seed, settings=settings, views=random)
        made += [shape.background(5) for shape in load_procedural_shapes(tmp_path, [folder.name])]
    assert len(np.unique(np.concatenate(made), axis=0)) == 20


def test_all_kinds_are_made_where_they_are_asked_for(tmp_path, views):
    made = []
    for kinds in ("abstract", "all"):
        (tmp_path / kinds).mkdir()
        settings = replace(SETTINGS, kinds=kinds, views=1, image_px=16)
        make_chunk(tmp_path / kinds, indices=range(6), seed=SEED, settings=settings, views=views)
        made.append([shape.kind for shape in load_procedural_shapes(tmp_path, [kinds])])
    assert set(made[0]) <= set(DEFAULT_KINDS)
    assert made[0] != made[1]
    assert resembled_families(tmp_path, ["abstract"]) == set()
    assert resembled_families(tmp_path, ["all"]) == {
        RESEMBLING_KINDS[kind] for kind in made[1] if kind in RESEMBLING_KINDS
    }
