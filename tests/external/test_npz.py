"""The points in an npz file."""

from datetime import datetime

import numpy as np
import pytest

from industnerf.errors import BadArtifact
from industnerf.external.points import read_cloud

POINTS = np.arange(12.0).reshape(4, 3)


def read_file(path):
    return read_cloud(path, 10, np.random.default_rng(0)).points


@pytest.mark.parametrize("dtype", ["f2", "f4", ">f8", "i4", "u1"])
def test_real_numbers_of_every_kind_are_taken(tmp_path, dtype):
    np.savez(tmp_path / "a.npz", points_mm=POINTS.astype(dtype))
    np.testing.assert_array_equal(read_file(tmp_path / "a.npz"), POINTS)


@pytest.mark.parametrize(
    "points",
    [
        POINTS + 1j,
        POINTS.astype(str),
        POINTS > 3,
        POINTS.astype("M8[s]"),
        np.zeros(4, [(axis, float) for axis in "xyz"]),
    ],
    ids=["complex", "text", "bool", "datetime", "structured"],
)
def test_what_are_no_real_numbers_is_refused_by_name(tmp_path, points):
    np.savez(tmp_path / "a.npz", points_mm=points)
    with pytest.raises(BadArtifact, match=r"a\.npz.*points_mm is of dtype .*, must be of real num"):
        read_file(tmp_path / "a.npz")


def error_text(path) -> str:
    with pytest.raises(BadArtifact, match=f"{path.name} cannot be read: ") as caught:
        read_file(path)
    assert "pickle" not in str(caught.value)
    return str(caught.value)


def test_what_is_no_npz_is_called_what_it_is(tmp_path):
    with (tmp_path / "single.npz").open("wb") as file:
        np.save(file, POINTS)
    (tmp_path / "text.npz").write_text("1 2 3\n4 5 6\n")
    (tmp_path / "empty.npz").touch()
    np.savez(tmp_path / "whole.npz", points_mm=POINTS)
    (tmp_path / "short.npz").write_bytes((tmp_path / "whole.npz").read_bytes()[:200])
    np.savez(tmp_path / "objects.npz", points_mm=np.array([datetime.min, None]))
    for name, reason in (
        ("single", "it is a .npy file"),
        ("text", "it is no npz: it begins with b'1 2 3"),
        ("empty", "it is empty (0 bytes)"),
        ("short", "it is cut short"),
        ("objects", "Python objects, which are not read"),
    ):
        assert reason in error_text(tmp_path / f"{name}.npz")


@pytest.mark.parametrize("dtype", ["f2", ">f8", "i4"])
def test_a_single_array_is_taken_with_a_word_on_further_columns(tmp_path, dtype):
    np.save(tmp_path / "a.npy", POINTS.astype(dtype))
    np.testing.assert_array_equal(read_file(tmp_path / "a.npy"), POINTS)
    np.save(tmp_path / "a.npy", np.hstack([POINTS, POINTS]).astype(dtype))
    content = read_cloud(tmp_path / "a.npy", 10, np.random.default_rng(0))
    np.testing.assert_array_equal(content.points, POINTS)
    assert content.warnings == ("of its 6 columns the first three are taken as x, y, z",)


def test_fields_are_taken_by_their_names(tmp_path):
    table = np.zeros(4, [("i", "u1"), ("z", "f4"), ("y", "f4"), ("x", "f4")])
    table["x"], table["y"], table["z"] = POINTS.T
    np.save(tmp_path / "a.npy", table)
    np.testing.assert_array_equal(read_file(tmp_path / "a.npy"), POINTS)


def test_what_is_no_array_of_points_is_called_what_it_is(tmp_path):
    np.save(tmp_path / "flat.npy", POINTS.ravel())
    np.save(tmp_path / "objects.npy", np.array([datetime.min, None]))
    (tmp_path / "text.npy").write_text("1 2 3\n")
    (tmp_path / "empty.npy").touch()
    np.savez(tmp_path / "a.npz", points=POINTS)
    (tmp_path / "several.npy").write_bytes((tmp_path / "a.npz").read_bytes())
    for name, reason in (
        ("flat", r"the array is of shape \(12,\), must be n x 3"),
        ("objects", "Python objects, which are not read"),
        ("text", "torn"),
        ("empty", "torn"),
        ("several", "it is an npz, named .npy"),
    ):
        with pytest.raises(BadArtifact, match=rf"{name}\.npy cannot be read: .*{reason}"):
            read_file(tmp_path / f"{name}.npy")
