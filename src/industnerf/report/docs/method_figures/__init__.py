"""Figures of docs/reference/method.md: the paper's figure 2, with what happens to one real part.

`pipeline_trace` runs the method and keeps intermediate values, `ray_profile` follows one ray.  A
module each draws inputs (3.1), sampling (3.2), rendering (3.3) and confidence (3.4).
"""
