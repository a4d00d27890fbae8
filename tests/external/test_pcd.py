"""PCD as the Point Cloud Library writes it, and what is torn."""

import numpy as np
import pytest

from industnerf.errors import BadArtifact, BadPart
from industnerf.external.pcd import decompress_lzf
from industnerf.external.points import read_cloud

POINTS = np.random.default_rng(0).normal(size=(40, 3)).astype(np.float32)
COLORS = np.arange(120, dtype=np.uint8).reshape(40, 3)
PACKED = (COLORS.astype(np.uint32) * [65536, 256, 1]).sum(axis=1).astype(np.uint32)


def header(storage, fields="x y z rgb", types="F F F U", sizes="4 4 4 4", count=40, view=""):
    names = fields.split()
    return (
        f"# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS {fields}\nSIZE {sizes}\n"
        f"TYPE {types}\nCOUNT {' '.join('1' * len(names))}\nWIDTH {count}\nHEIGHT 1\n{view}"
        f"POINTS {count}\nDATA {storage}\n"
    ).encode()


def binary_rows():
    table = np.empty(40, [("p", "<f4", 3), ("rgb", "<u4")])
    table["p"], table["rgb"] = POINTS, PACKED
    return table.tobytes()


def literal_lzf(data):
    """LZF that compresses nothing: runs of at most 32 bytes as they are."""
    runs = [data[at : at + 32] for at in range(0, len(data), 32)]
    return b"".join(bytes([len(run) - 1]) + run for run in runs)


def compressed(data, size=None):
    packed = literal_lzf(data)
    return np.array([len(packed), size or len(data)], "<u4").tobytes() + packed


def text_rows():
    rows = zip(POINTS.tolist(), PACKED.tolist(), strict=True)
    return "".join(f"{x} {y} {z} {rgb}\n" for (x, y, z), rgb in rows).encode()


COLUMNS = b"".join(column.tobytes() for column in (*np.ascontiguousarray(POINTS.T), PACKED))


@pytest.fixture
def read(tmp_path):
    def read_bytes(data):
        (tmp_path / "a.pcd").write_bytes(data)
        return read_cloud(tmp_path / "a.pcd", 10, np.random.default_rng(0))

    return read_bytes


@pytest.mark.parametrize(
    "data",
    [
        header("ascii") + text_rows(),
        header("ascii", types="F F F F") + text_rows(),  # colors are packed into a float
        header("binary") + binary_rows(),
        header("binary", types="F F F F") + binary_rows(),
        header("binary_compressed") + compressed(COLUMNS),
    ],
)
def test_points_and_colors_are_those_that_were_written(read, data):
    content = read(data)
    np.testing.assert_allclose(content.points, POINTS, atol=1e-6)
    np.testing.assert_array_equal(content.colors, COLORS)
    assert content.warnings == ()


def test_columns_may_be_of_any_type_and_place_with_padding_between(read):
    table = np.zeros(40, [("i", "u1"), ("_", "u1", 3), ("z", "<f8"), ("y", "<f8"), ("x", "<f8")])
    table["x"], table["y"], table["z"] = POINTS.T
    head = header("binary", "intensity _ _ _ z y x", "U U U U F F F", "1 1 1 1 8 8 8")
    np.testing.assert_array_equal(read(head + table.tobytes()).points, POINTS)


def test_pixels_without_a_point_are_left_out(read):
    """An organized cloud has a row a pixel, and NaN where the sensor saw nothing."""
    rows = POINTS.copy()
    rows[::4] = np.nan
    head = header("binary", "x y z", "F F F", "4 4 4", view="VIEWPOINT 1 0 0 1 0 0 0\n")
    content = read(head + rows.tobytes())
    assert len(content.points) == 30
    assert content.warnings == (
        "its VIEWPOINT is not applied: points are as they stand",
        "10 of its 40 points are not finite and are left out",
    )


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (header("binary") + binary_rows()[:-1], "promises 640 bytes, the file holds 639: it is cu"),
        (
            header("ascii") + b"".join(text_rows().splitlines(True)[:-1]),
            "promises 40 points, the file holds 39",
        ),
        (header("ascii", count=1) + b"1 2 3\n", "point 1 has 3 numbers, not 4"),
        (header("binary_compressed") + compressed(COLUMNS)[:-3], "it is cut short"),
        (header("binary_compressed") + compressed(COLUMNS, 99), "40 points of 16 bytes, but 99"),
        (header("binary", "x y i", "F F F", "4 4 4") + bytes(480), "no column z among x, y, i"),
        (header("gzip"), "DATA is 'gzip', must be one of ascii, binary, binary_compressed"),
        (header("ascii", types="F F F Q"), "its header makes no sense: KeyError: 'Q'"),
        (header("ascii", sizes="4 4 4"), "its header makes no sense: ValueError"),
        (b"VERSION 0.7\n", "its header has no DATA"),
        (b"", "its header has no DATA"),
    ],
)
def test_what_is_torn_is_said_by_name(read, data, reason):
    with pytest.raises(BadArtifact, match=rf"a\.pcd cannot be read: PCD: .*{reason}"):
        read(data)


@pytest.mark.parametrize(
    ("packed", "unpacked"),
    [
        (b"\x02abc", b"abc"),
        (b"\x02abc\x20\x02", b"abcabc"),  # length 1 + 2, distance 2 + 1
        (b"\x00a\xe0\x01\x00", b"a" * 11),  # runs into itself: length 7 + 1 + 2, distance 1
        (b"\x1f" + bytes(range(32)) + b"\x40\x1f", bytes(range(32)) + bytes(range(4))),
    ],
)
def test_lzf_by_hand(packed, unpacked):
    assert decompress_lzf(packed, len(unpacked)) == unpacked


def test_torn_lzf_is_refused():
    for packed in (b"\x20\x02", b"\x02abc\x20", b"\x05abc"):
        with pytest.raises(BadPart, match=r"torn|cut short"):
            decompress_lzf(packed, 6)
