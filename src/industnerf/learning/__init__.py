"""Shared by methods that learn from other parts: images, targets, encoder, training loop.

All shapes are in the unit cube [-1/2, 1/2]^3 of `geometry.bounding_cube.BoundingCube`.
"""
