"""A cloud of colored, more or less opaque points seen along rays -- paper, 3.3 and 3.4.

Lengths (step, radius, t, the box) share the unit of the points; a density sigma is per that unit.
Rays are sampled inside the box [lo, hi].  The equations stand in `compositing.py` (10) and
`confidence.py` (11)-(13); `compiled_renderer.py` and `torch_renderer.py` both execute them.
"""
