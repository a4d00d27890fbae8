"""A cloud of colored, more or less opaque points seen along rays -- paper, 3.3 and 3.4.

Lengths (step, radius, t, the cube) share the unit of the points, and a density sigma counts per
that unit.  `o` is a ray's origin, `d` its unit direction; the cube [lo, hi] is where it is sampled.
"""
