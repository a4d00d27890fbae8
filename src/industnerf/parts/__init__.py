"""The parts of the suite, and CAD files of the user's own.

catalogue/   the embedded parts: `entries` reads them and needs numpy alone; `families` draws the
             industrial ones with the `[cad]` extra, `organic` the others without it
io/          readers and writers of CAD files, ingest and export
procedural/  CAD-like solids from a seed, to learn from
repair/      from the solids of a file to one clean mesh
validation/  the checks of a mesh, and `python -m industnerf.parts check`

Lengths are in mm, in the frame in which the part was drawn.
"""
