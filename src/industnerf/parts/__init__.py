"""The parts of the suite: drawn, baked, catalogued and checked.

`catalogue` reads the baked meshes and needs numpy alone.  `families` draws them and `bake` writes
them; both need the `[cad]` extra.  Lengths are in mm, in the frame in which the part was drawn.
"""
