"""What a method has learned, written and read."""

import numpy as np
import pytest

from industnerf.artifacts.history import History
from industnerf.artifacts.state import ModelState
from industnerf.errors import BadArtifact

CURVE = History(np.arange(3), np.array([3.0, 2.0, 1.0]), {})
STATE = ModelState({"a": np.arange(6).reshape(2, 3), "b": np.float32(0.5)}, 78, "cpu", 6, 3, False)


def test_a_state_survives_its_files(tmp_path):
    STATE.save(tmp_path)
    read = ModelState.load(tmp_path)
    np.testing.assert_array_equal(read.arrays["a"], STATE.arrays["a"])
    assert read.arrays["b"] == np.float32(0.5)
    assert (read.num_parts, read.size, read.num_parameters) == (78, "cpu", 6)
    assert (read.steps, read.converged) == (3, False)
    assert read.train_history is None


def test_both_curves_are_kept(tmp_path):
    curve = History(np.array([0, 2]), np.array([2.0, 1.5]), {})
    ModelState({}, 1, train_history=CURVE, val_history=curve).save(tmp_path)
    read = ModelState.load(tmp_path)
    np.testing.assert_array_equal(read.train_history.loss, CURVE.loss)
    np.testing.assert_array_equal(read.val_history.steps, [0, 2])


def test_the_summary_needs_no_arrays(tmp_path):
    STATE.save(tmp_path)
    (tmp_path / "state.npz").unlink()
    expected = {"num_parts": 78, "size": "cpu", "num_parameters": 6, "steps": 3, "converged": False}
    assert ModelState.summary(tmp_path) == expected
    with pytest.raises(BadArtifact, match=r"state\.npz"):
        ModelState.load(tmp_path)


def test_the_same_state_has_the_same_bytes(tmp_path):
    for name in ("first", "again"):
        (tmp_path / name).mkdir()
        STATE.save(tmp_path / name)
    files = [(tmp_path / name / "state.npz").read_bytes() for name in ("first", "again")]
    assert files[0] == files[1]
