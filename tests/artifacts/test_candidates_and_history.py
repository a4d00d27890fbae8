"""What a method may leave beside its cloud: read as it was written, or an error that names it."""

import numpy as np
import pytest

from industnerf.artifacts.candidates import Candidates
from industnerf.artifacts.history import History
from industnerf.errors import BadArtifact

CANDIDATES = Candidates(
    np.arange(9, dtype=np.float32).reshape(3, 3), np.array([0, 0.5, 1], np.float32)
)
HISTORY = History(
    np.array([0, 10, 20]), np.array([0.3, np.nan, 0.1]), {"32 cells": 0, "64 cells": 15}
)
BOTH = pytest.mark.parametrize("artifact", [CANDIDATES, HISTORY])


@BOTH
def test_it_survives_its_file(tmp_path, artifact):
    artifact.save(tmp_path)
    read = type(artifact).load(tmp_path)
    for name, value in vars(artifact).items():
        np.testing.assert_array_equal(getattr(read, name), value)


@BOTH
def test_equal_content_is_equal_bytes(tmp_path, artifact):
    contents = set()
    for _ in range(2):
        artifact.save(tmp_path)
        (path,) = tmp_path.iterdir()
        contents.add(path.read_bytes())
        path.unlink()
    assert len(contents) == 1


def test_a_history_without_levels_or_steps_is_one(tmp_path):
    History(np.zeros(0, int), np.zeros(0), {}).save(tmp_path)
    assert History.load(tmp_path).levels == {}


@BOTH
def test_a_method_that_keeps_none_has_none(tmp_path, artifact):
    assert type(artifact).load(tmp_path) is None


@BOTH
def test_a_torn_file_is_named_with_the_stage_that_mends_it(tmp_path, artifact):
    artifact.save(tmp_path)
    (path,) = tmp_path.iterdir()
    path.write_bytes(path.read_bytes()[:50])
    with pytest.raises(BadArtifact, match=rf"{path.name}.*dvc repro -f -s reconstruct"):
        type(artifact).load(tmp_path)


@BOTH
def test_another_schema_or_shape_is_refused(tmp_path, artifact):
    artifact.save(tmp_path)
    (path,) = tmp_path.iterdir()
    with np.load(path) as arrays:
        written = dict(arrays)
    first = {"Candidates": "confidence", "History": "loss"}[type(artifact).__name__]
    for corrupted in ({"schema": 99}, {first: written[first][:1]}):
        np.savez_compressed(path, **(written | corrupted))
        with pytest.raises(BadArtifact, match=path.name):
            type(artifact).load(tmp_path)
