"""Numbers of a glTF file: views of buffers, each held against the bytes that are there."""

from collections.abc import Callable
from typing import Any

import numpy as np

from industnerf.errors import BadPart

TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Buffers:
    """The buffers of one file, each loaded once."""

    def __init__(self, tree: dict[str, Any], load: Callable[[str | None], bytes]) -> None:
        self._tree, self.load = tree, load
        self._loaded: dict[int, bytes] = {}

    def read_view(self, index: int) -> bytes:
        """The bytes of a buffer view; raises BadPart if the buffer is shorter."""
        view = self._tree["bufferViews"][index]
        offset, length, buffer_index = view.get("byteOffset", 0), view["byteLength"], view["buffer"]
        if buffer_index not in self._loaded:
            self._loaded[buffer_index] = self.load(self._tree["buffers"][buffer_index].get("uri"))
        data = self._loaded[buffer_index]
        if offset < 0 or length < 0 or offset + length > len(data):
            raise BadPart(f"glTF: a view ends at byte {offset + length} of a buffer of {len(data)}")
        return data[offset : offset + length]

    def read_accessor(self, index: int) -> np.ndarray:
        """(count, width) numbers of an accessor; whole ones that stand for shares become shares."""
        accessor = self._tree["accessors"][index]
        if "bufferView" not in accessor or "sparse" in accessor:
            raise BadPart("glTF: an accessor is sparse or compressed (Draco?); export it plainly")
        dtype = np.dtype(TYPES[accessor["componentType"]])
        count, width = accessor["count"], WIDTH[accessor["type"]]
        data, offset = self.read_view(accessor["bufferView"]), accessor.get("byteOffset", 0)
        row = dtype.itemsize * width
        stride = self._tree["bufferViews"][accessor["bufferView"]].get("byteStride", row)
        if (
            count < 1
            or stride < row
            or offset < 0
            or offset + (count - 1) * stride + row > len(data)
        ):
            raise BadPart(
                f"glTF: an accessor promises {count} rows of {row} bytes, its view holds "
                f"{len(data)}"
            )
        table = np.ndarray((count, width), dtype, data, offset, (stride, dtype.itemsize)).copy()
        if accessor.get("normalized") and dtype.kind in "iu":
            return table / np.iinfo(dtype).max
        return table
