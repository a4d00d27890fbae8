"""Chunks of solids on disk, and their rows as shapes to learn from."""

import os
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from industnerf.errors import BadParams
from industnerf.learning.procedural_shapes import (
    ProceduralArrays,
    load_procedural_shapes,
    resembled_families,
)
from industnerf.learning.training_shape import TrainingShape
from industnerf.learning.views import resize_images
from industnerf.methods.base import Example


def arrays(solids, seed=0):
    """At random; three views of 8 px."""
    rng = np.random.default_rng(seed)
    return ProceduralArrays(
        rng.integers(0, 256, (solids, 3, 8, 8, 3), np.uint8),
        rng.random((solids, 3, 3), np.float32),
        rng.random((solids, 3, 3, 3), np.float32),
        rng.integers(0, 256, (solids, 4, 4, 4), np.uint8),
        rng.random((solids, 16, 3), np.float32).astype(np.float16),
        np.tile(np.float32([0.25, 0.25, 0.5]), (solids, 1)),
        rng.random((solids, 20, 3), np.float32).astype(np.float16),
    )


def save_chunk(folder, name, kinds, seed=0, resembles=None):
    (folder / name).mkdir()
    saved = arrays(len(kinds), seed)
    saved.save(folder / name, kinds, resembles or [None] * len(kinds))
    return saved


@pytest.fixture
def chunks(tmp_path):
    """The arrays of two chunks."""
    return save_chunk(tmp_path, "0000", ["a", "b"]), save_chunk(tmp_path, "0001", ["c"], seed=1)


def test_what_is_saved_is_loaded_row_by_row(chunks, tmp_path):
    shapes = load_procedural_shapes(tmp_path, ["0000", "0001"])
    assert [shape.kind for shape in shapes] == ["a", "b", "c"]
    assert len({shape.part_id for shape in shapes}) == 3
    assert all(shape.group == shape.part_id for shape in shapes)
    rows = [(chunks[0], 0), (chunks[0], 1), (chunks[1], 0)]
    for shape, (saved, row) in zip(shapes, rows, strict=True):
        rng = np.random.default_rng(0)
        np.testing.assert_array_equal(shape.rgb(8, 2), saved.images[row, :2])
        np.testing.assert_array_equal(shape.rgb(8, 9), saved.images[row])
        np.testing.assert_array_equal(shape.rgb(4, 2), resize_images(saved.images[row, :2], 4))
        np.testing.assert_array_equal(shape.background(2), saved.backgrounds[row, :2])
        np.testing.assert_array_equal(shape.picture_frames(2), saved.frames[row, :2])
        np.testing.assert_array_equal(shape.filled_shares(), saved.filled[row])
        np.testing.assert_array_equal(shape.surface_pool(rng), saved.surface[row])
        pool = shape.occupancy_pool(99, rng)
        np.testing.assert_array_equal(pool.points, saved.points[row])
        np.testing.assert_array_equal(pool.shares, saved.shares[row])


def test_every_solid_knows_the_family_that_it_resembles(tmp_path):
    save_chunk(tmp_path, "0000", ["nut", "a"], resembles=["nuts", None])
    save_chunk(tmp_path, "0001", ["gear", "a"], resembles=["gears", None])
    shapes = load_procedural_shapes(tmp_path, ["0000", "0001"])
    assert [shape.resembles for shape in shapes] == ["nuts", None, "gears", None]
    assert resembled_families(tmp_path, ["0000", "0001"]) == {"nuts", "gears"}
    assert resembled_families(tmp_path, []) == set()


def test_arrays_stay_on_disk(chunks, tmp_path):
    for shape in load_procedural_shapes(tmp_path, ["0000", "0001"]):
        for field in fields(ProceduralArrays):
            array = getattr(shape.arrays, field.name)
            assert isinstance(array, np.memmap) or isinstance(array.base, np.memmap)
            assert not array.flags.writeable


def test_a_chunk_costs_one_open_file(tmp_path):
    """A process may open 1024 files in many a system, and 20 000 solids are 200 chunks."""
    names = [f"{i:04d}" for i in range(20)]
    for name in names:
        save_chunk(tmp_path, name, ["a"])
    before = len(os.listdir("/proc/self/fd"))
    shapes = load_procedural_shapes(tmp_path, names)
    assert len(os.listdir("/proc/self/fd")) - before <= len(names)
    assert len(shapes) == 20


def test_solids_and_parts_offer_the_same(chunks, tmp_path):
    (solid, *_) = load_procedural_shapes(tmp_path, ["0000"])
    part = Example("p", "p", Path("part"), Path("views"), frozenset())
    assert isinstance(solid, TrainingShape)
    assert isinstance(part, TrainingShape)


def test_images_larger_than_are_stored_name_the_knob(chunks, tmp_path):
    (solid, *_) = load_procedural_shapes(tmp_path, ["0000"])
    with pytest.raises(BadParams, match=r"images of 9 px.* with 8: raise procedural\.image_px"):
        solid.rgb(9, 2)


def test_no_chunk_is_no_solid(tmp_path):
    assert load_procedural_shapes(tmp_path, []) == []


def test_equal_arrays_are_equal_bytes(tmp_path):
    saved = arrays(2)
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
        replace(saved).save(tmp_path / name, ["a", "b"], [None, "gears"])
    files = sorted(path.name for path in (tmp_path / "one").iterdir())
    assert files
    for name in files:
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "other" / name).read_bytes()
