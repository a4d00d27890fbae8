"""PCD, the format of the Point Cloud Library: text, binary, or binary compressed by LZF.

A header of lines names the columns (FIELDS, SIZE, TYPE, COUNT), and DATA how they are kept.
Compressed, the columns follow one another; else the points do.
-- pointclouds.org/documentation/tutorials/pcd_file_format.html; LZF: Marc Lehmann, liblzf.
"""

from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from industnerf.errors import BadPart
from industnerf.external.cloud_content import CloudContent

KINDS = {"F": "f", "I": "i", "U": "u"}
AXES = ("x", "y", "z")
NO_VIEWPOINT = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]  # the identity: translation, quaternion


def read_pcd(file: Path) -> CloudContent:
    """Raises BadPart if the header makes no sense, or promises more than the file holds."""
    header, body = _read_header(file.read_bytes())
    try:
        dtype = _dtype(header)
        count = int(header.get("POINTS", ["0"])[0])
        storage = header["DATA"][0].lower()
    except (KeyError, IndexError, ValueError, TypeError) as error:
        raise BadPart(f"PCD: its header makes no sense: {type(error).__name__}: {error}") from None
    if missing := [axis for axis in AXES if axis not in dtype.names]:
        raise BadPart(f"PCD: no column {', '.join(missing)} among {', '.join(dtype.names)}")
    readers = {"ascii": _read_text, "binary": _read_rows, "binary_compressed": _read_columns}
    if storage not in readers:
        raise BadPart(f"PCD: DATA is {storage!r}, must be one of {', '.join(readers)}")
    table = readers[storage](body, dtype, count)
    points = np.stack([np.asarray(table[axis], np.float64).ravel() for axis in AXES], axis=1)
    viewpoint = [float(number) for number in header.get("VIEWPOINT", [])]
    moved = bool(viewpoint) and viewpoint != NO_VIEWPOINT
    warnings = ("its VIEWPOINT is not applied: points are as they stand",) if moved else ()
    return CloudContent(points, warnings, colors=_colors(table))


def _read_header(data: bytes) -> tuple[dict[str, list[str]], bytes]:
    """Its lines by their first word, and what lies behind DATA."""
    header: dict[str, list[str]] = {}
    start = 0
    while "DATA" not in header:
        end = data.find(b"\n", start)
        if end < 0 or end - start > 1000:
            raise BadPart("PCD: its header has no DATA")
        name, *values = data[start:end].decode("ascii", errors="replace").split() or [""]
        start = end + 1
        if name and not name.startswith("#"):
            header[name.upper()] = values
    return header, data[start:]


def _dtype(header: dict[str, list[str]]) -> np.dtype:
    names = header["FIELDS"]
    counts = [int(count) for count in header.get("COUNT", ["1"] * len(names))]
    kinds = [
        f"<{KINDS[kind.upper()]}{int(size)}"
        for kind, size in zip(header["TYPE"], header["SIZE"], strict=True)
    ]
    # padding is named `_`, as often as there is some
    unique = [f"{name}{i}" if name == "_" else name for i, name in enumerate(names)]
    return np.dtype(list(zip(unique, kinds, [(n,) for n in counts], strict=True)))


def _read_text(body: bytes, dtype: np.dtype, count: int) -> np.ndarray:
    widths = [dtype[name].shape[0] for name in dtype.names]
    rows = [line.split() for line in body.decode("ascii", errors="replace").splitlines()]
    rows = [row for row in rows if row]
    _require(count, len(rows), "points")
    table = np.empty(count, dtype)
    for number, row in enumerate(rows[:count]):
        if len(row) != sum(widths):
            raise BadPart(f"PCD: point {number + 1} has {len(row)} numbers, not {sum(widths)}")
    cells = np.array(rows[:count]).reshape(count, sum(widths))
    for name, width, end in zip(dtype.names, widths, np.cumsum(widths), strict=True):
        column = cells[:, end - width : end]
        # a packed color is written as a whole number under a type of float
        is_packed = name in ("rgb", "rgba") and "." not in "".join(column[:1].ravel())
        if is_packed and dtype[name].base.kind == "f":
            table[name] = column.astype(np.float64).astype(np.uint32).view(np.float32)
        else:
            table[name] = column.astype(np.float64)
    return table


def _read_rows(body: bytes, dtype: np.dtype, count: int) -> np.ndarray:
    _require(count * dtype.itemsize, len(body), "bytes")
    return np.frombuffer(body, dtype, count)


def _read_columns(body: bytes, dtype: np.dtype, count: int) -> np.ndarray:
    _require(8, len(body), "bytes")
    compressed, size = (int(number) for number in np.frombuffer(body, "<u4", 2))
    _require(compressed, len(body) - 8, "bytes")
    if size != count * dtype.itemsize:
        raise BadPart(f"PCD: {count} points of {dtype.itemsize} bytes, but {size} are packed")
    data = decompress_lzf(body[8 : 8 + compressed], size)
    table, start = np.empty(count, dtype), 0
    for name in dtype.names:
        column = np.frombuffer(data, dtype[name].base, table[name].size, start)
        table[name] = column.reshape(table[name].shape)
        start += column.nbytes
    return table


def decompress_lzf(data: bytes, size: int) -> bytes:
    """The `size` bytes that LZF packed into `data`; raises BadPart if it holds another number.

    A control byte below 32 goes before that many bytes and one, as they are.  Any other is the
    length (3 bits, 7: a further byte) and the distance (5 bits and a byte) of a repetition.
    """
    out, at = bytearray(), 0
    try:
        while at < len(data):
            control = data[at]
            at += 1
            if control < 32:
                out += data[at : at + control + 1]
                at += control + 1
                continue
            length = control >> 5
            if length == 7:
                length += data[at]
                at += 1
            start = len(out) - ((control & 31) << 8) - data[at] - 1
            at += 1
            if start < 0:
                raise IndexError("a repetition of what lies before the start")
            length += 2
            piece = out[start : start + length]
            out += (piece * (length // len(piece) + 1))[:length]  # it may run into itself
    except IndexError as error:
        raise BadPart(f"PCD: its compressed points are torn: {error}") from None
    if len(out) != size:
        raise BadPart(f"PCD: {len(out)} bytes unpacked, {size} promised: it is cut short")
    return bytes(out)


def _require(needed: int, available: int, what: str) -> None:
    if available < needed:
        raise BadPart(
            f"PCD: header promises {needed} {what}, the file holds {available}: it is cut short"
        )


def _colors(table: np.ndarray) -> UInt8[np.ndarray, "n 3"] | None:
    """The color packed as 0x00RRGGBB into one number; None without one."""
    name = next((name for name in ("rgb", "rgba") if name in table.dtype.names), None)
    if name is None or table.dtype[name].base.itemsize != 4:
        return None
    packed = np.ascontiguousarray(table[name].ravel()).view(np.uint32)
    return np.stack([packed >> shift & 255 for shift in (16, 8, 0)], axis=1).astype(np.uint8)
