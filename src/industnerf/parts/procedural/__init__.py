"""CAD-like solids from a seed: shapes to learn from that are no part of the study."""

from industnerf.parts.procedural.kinds import ALL_KINDS, DEFAULT_KINDS, RESEMBLING_KINDS
from industnerf.parts.procedural.solid import ProceduralSolid, digest, procedural_solid

__all__ = [
    "ALL_KINDS",
    "DEFAULT_KINDS",
    "RESEMBLING_KINDS",
    "ProceduralSolid",
    "digest",
    "procedural_solid",
]
