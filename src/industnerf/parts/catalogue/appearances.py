"""The finishes that embedded parts are made of.

Albedos are ours, chosen by eye to tell materials apart.  They are linear: at most 0.72, so that
the three lamps of params.yaml do not drive a lit face into the white of the background, and none
as dark as rubber really is, so that shading survives 8 linear bits.
"""

from industnerf.artifacts.part import Appearance

_TABLE = (
    Appearance("steel", (0.56, 0.57, 0.58), 1.0, 0.35),
    Appearance("bright steel", (0.70, 0.71, 0.72), 1.0, 0.15),
    Appearance("black oxide", (0.16, 0.16, 0.17), 1.0, 0.45),
    Appearance("zinc", (0.60, 0.64, 0.70), 1.0, 0.30),
    Appearance("cast iron", (0.40, 0.40, 0.41), 1.0, 0.70),
    Appearance("aluminum", (0.68, 0.69, 0.70), 1.0, 0.40),
    Appearance("brass", (0.68, 0.52, 0.20), 1.0, 0.30),
    Appearance("bronze", (0.55, 0.35, 0.18), 1.0, 0.40),
    Appearance("copper", (0.70, 0.38, 0.26), 1.0, 0.30),
    Appearance("blue paint", (0.14, 0.30, 0.62), 0.0, 0.40),
    Appearance("green paint", (0.20, 0.48, 0.28), 0.0, 0.40),
    Appearance("red paint", (0.62, 0.14, 0.12), 0.0, 0.40),
    Appearance("yellow paint", (0.72, 0.56, 0.12), 0.0, 0.40),
    Appearance("gray paint", (0.42, 0.44, 0.46), 0.0, 0.50),
    Appearance("rubber", (0.12, 0.12, 0.12), 0.0, 0.90),
    Appearance("black plastic", (0.15, 0.15, 0.16), 0.0, 0.50),
    Appearance("white plastic", (0.72, 0.71, 0.68), 0.0, 0.50),
)
APPEARANCES: dict[str, Appearance] = {finish.name: finish for finish in _TABLE}
