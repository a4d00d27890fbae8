"""Colours of 3MF: groups of base materials and colours, which triangles point into."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float64

from industnerf.parts.reading.content import unpainted
from industnerf.parts.reading.paint import hex_colour

COLOURS = {"basematerials": ("base", "displaycolor"), "colorgroup": ("color", "color")}
OTHERS = ("texture2dgroup", "compositematerials", "multiproperties")


@dataclass(frozen=True)
class Groups:
    """The colour groups of one model file by id, and the ids of other groups."""

    colours: dict[str, Float64[np.ndarray, "k 3"]]
    others: frozenset[str]

    @staticmethod
    def of(model: Any) -> "Groups":
        """The groups among the resources of `model`."""
        colours, others = {}, set()
        for node in model.iterfind("{*}resources/*"):
            tag = str(node.tag).rpartition("}")[2]
            if tag in COLOURS:
                child, attribute = COLOURS[tag]
                found = [hex_colour(c.get(attribute, "")) for c in node.iterfind(f"{{*}}{child}")]
                rows = [unpainted(1)[0] if colour is None else colour for colour in found]
                colours[node.get("id", "")] = np.array(rows).reshape(-1, 3)
            elif tag in OTHERS:
                others.add(node.get("id", ""))
        return Groups(colours, frozenset(others))

    def albedo(
        self, triangles: list[Any], pid: str | None, pindex: str | None
    ) -> tuple[Float64[np.ndarray, "m 3"], list[str]]:
        """Of each triangle the mean of its corners' colours, and what could not be kept.

        `pid` and `pindex` are the object's own, for triangles that name none.
        """
        albedo, known, lost = unpainted(len(triangles)), {}, set()
        for row, triangle in enumerate(triangles):
            group = triangle.get("pid", pid)
            if group is None:
                continue
            first = triangle.get("p1", pindex)
            key = (group, first, triangle.get("p2", first), triangle.get("p3", first))
            if key not in known:
                known[key] = self._mean(key[0], key[1:])
            if known[key] is None:
                lost.add(group)
            else:
                albedo[row] = known[key]
        kinds = {"pictures or blends" if group in self.others else "colours" for group in lost}
        return albedo, [f"{kind} that cannot be resolved are left out" for kind in sorted(kinds)]

    def _mean(self, group: str, corners: tuple[str | None, ...]) -> Float64[np.ndarray, "3"] | None:
        try:
            indices = [int(corner) for corner in corners if corner is not None]
            table = self.colours[group]
            if not indices or min(indices) < 0:
                return None
            return table[indices].mean(axis=0)
        except (KeyError, IndexError, ValueError):
            return None
