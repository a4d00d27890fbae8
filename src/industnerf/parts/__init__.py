"""The parts of the suite: drawn, baked, catalogued and checked.

`catalogue` reads the baked meshes and needs numpy alone.  `families` draws the industrial ones with
the `[cad]` extra, `organic` the others without it; `bake` writes them.
Lengths are in mm, in the frame in which the part was drawn.
"""
