"""Procedural solids as networks learn from them: views and targets, packed by the hundred.

    <chunk>/kinds.json  <chunk>/solids.npy   one row a solid, one column each array

Files are mapped, so that processes side by side share one copy of thousands of solids, and a
training needs no more memory with them than without.  A mapped file stays open, and a system lets
a process open a thousand or so: hence one a chunk.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float16, Float32, UInt8

from industnerf.artifacts.files import read_json, write_json
from industnerf.errors import BadParams
from industnerf.learning.targets import OccupancyPool
from industnerf.learning.views import resize_images

SCHEMA = 2
FILE, KINDS_FILE = "solids.npy", "kinds.json"


@dataclass(frozen=True)
class ProceduralArrays:
    """What is known of so many solids, one row each; the targets are those of `targets`."""

    images: UInt8[np.ndarray, "solids views px px 3"]  # in nested order
    backgrounds: Float32[np.ndarray, "solids views 3"]
    frames: Float32[np.ndarray, "solids views 3 3"]
    filled: UInt8[np.ndarray, "solids n n n"]
    points: Float16[np.ndarray, "solids pool 3"]
    shares: Float32[np.ndarray, "solids 3"]
    surface: Float16[np.ndarray, "solids dense 3"]

    def save(self, folder: Path, kinds: Sequence[str], resembles: Sequence[str | None]) -> None:
        """Write every array into `folder`, with every solid's kind and the family it resembles."""
        columns = {field.name: getattr(self, field.name) for field in fields(self)}
        rows = np.empty(len(kinds), [(k, v.dtype, v.shape[1:]) for k, v in columns.items()])
        for name, column in columns.items():
            rows[name] = column
        np.save(folder / FILE, rows)
        record = {"schema": SCHEMA, "kinds": list(kinds), "resembles": list(resembles)}
        write_json(folder / KINDS_FILE, record)


@dataclass(frozen=True)
class ProceduralShape:
    """One row of `arrays`, as a `TrainingShape`."""

    part_id: str
    group: str
    kind: str
    resembles: str | None  # a family of the study
    arrays: ProceduralArrays
    row: int

    def rgb(self, px: int, count: int) -> UInt8[np.ndarray, "views {px} {px} 3"]:
        """Raises BadParams if `px` is more than the solids were rendered with."""
        images = self.arrays.images[self.row, :count]
        if px > images.shape[1]:
            raise BadParams(
                f"a network takes images of {px} px, but procedural solids were rendered with "
                f"{images.shape[1]}: raise procedural.image_px"
            )
        return images if px == images.shape[1] else resize_images(images, px)

    def background(self, count: int) -> Float32[np.ndarray, "views 3"]:
        return self.arrays.backgrounds[self.row, :count]

    def picture_frames(self, count: int) -> Float32[np.ndarray, "views 3 3"]:
        return self.arrays.frames[self.row, :count]

    def filled_shares(self) -> UInt8[np.ndarray, "n n n"]:
        return self.arrays.filled[self.row]

    def occupancy_pool(self, count: int, rng: np.random.Generator) -> OccupancyPool:
        """As many points as are stored, however many are wanted."""
        return OccupancyPool(self.arrays.points[self.row], self.arrays.shares[self.row])

    def surface_pool(self, rng: np.random.Generator) -> Float16[np.ndarray, "dense 3"]:
        return self.arrays.surface[self.row]


def load_procedural_shapes(folder: Path, chunks: Sequence[str]) -> list[ProceduralShape]:
    """The solids of all `chunks` in `folder`, in their order; each is a group of its own.

    Raises BadArtifact if a chunk was written by another version.
    """
    shapes: list[ProceduralShape] = []
    for chunk in chunks:
        record = _read_kinds(folder / chunk)
        rows = np.load(folder / chunk / FILE, mmap_mode="r")
        arrays = ProceduralArrays(
            **{field.name: rows[field.name] for field in fields(ProceduralArrays)}
        )
        pairs = zip(record["kinds"], record["resembles"], strict=True)
        for row, (kind, family) in enumerate(pairs):
            part_id = f"procedural-{len(shapes):05d}"
            shapes.append(ProceduralShape(part_id, part_id, kind, family, arrays, row))
    return shapes


def resembled_families(folder: Path, chunks: Sequence[str]) -> set[str]:
    """The families of the study that some solid of `chunks` resembles."""
    families = {family for chunk in chunks for family in _read_kinds(folder / chunk)["resembles"]}
    return families - {None}


def _read_kinds(chunk: Path) -> dict[str, Any]:
    return read_json(chunk / KINDS_FILE, SCHEMA, "procedural")
