"""Colors of 3MF: groups of base materials and colors, which triangles point into."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float64

from industnerf.parts.io.readers.colors import parse_hex
from industnerf.parts.io.readers.mesh_content import unstated_albedo

COLOR_GROUPS = {"basematerials": ("base", "displaycolor"), "colorgroup": ("color", "color")}
OTHER_GROUPS = ("texture2dgroup", "compositematerials", "multiproperties")


@dataclass(frozen=True)
class ColorGroups:
    """The color groups of one model file by id, and the ids of other groups."""

    colors: dict[str, Float64[np.ndarray, "k 3"]]
    other_ids: frozenset[str]

    @staticmethod
    def from_model(model: Any) -> "ColorGroups":
        """The groups among the resources of `model`."""
        colors, other_ids = {}, set()
        for node in model.iterfind("{*}resources/*"):
            tag = str(node.tag).rpartition("}")[2]
            if tag in COLOR_GROUPS:
                child, attribute = COLOR_GROUPS[tag]
                parsed = [parse_hex(c.get(attribute, "")) for c in node.iterfind(f"{{*}}{child}")]
                rows = [unstated_albedo(1)[0] if color is None else color for color in parsed]
                colors[node.get("id", "")] = np.array(rows).reshape(-1, 3)
            elif tag in OTHER_GROUPS:
                other_ids.add(node.get("id", ""))
        return ColorGroups(colors, frozenset(other_ids))

    def albedo(
        self, triangles: list[Any], pid: str | None, pindex: str | None
    ) -> tuple[Float64[np.ndarray, "m 3"], list[str]]:
        """Of each triangle the mean of its corners' colors, and what could not be kept.

        `pid` and `pindex` are the object's own, for triangles that name none.
        """
        albedo, cache, unresolved = unstated_albedo(len(triangles)), {}, set()
        for row, triangle in enumerate(triangles):
            group = triangle.get("pid", pid)
            if group is None:
                continue
            first = triangle.get("p1", pindex)
            key = (group, first, triangle.get("p2", first), triangle.get("p3", first))
            if key not in cache:
                cache[key] = self._mean(key[0], key[1:])
            if cache[key] is None:
                unresolved.add(group)
            else:
                albedo[row] = cache[key]
        kinds = {
            "pictures or blends" if group in self.other_ids else "colors" for group in unresolved
        }
        return albedo, [f"{kind} that cannot be resolved are left out" for kind in sorted(kinds)]

    def _mean(self, group: str, corners: tuple[str | None, ...]) -> Float64[np.ndarray, "3"] | None:
        try:
            indices = [int(corner) for corner in corners if corner is not None]
            table = self.colors[group]
            if not indices or min(indices) < 0:
                return None
            return table[indices].mean(axis=0)
        except (KeyError, IndexError, ValueError):
            return None
