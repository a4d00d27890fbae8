"""Cameras, rays and visibility: pure functions, lengths in mm.

Camera axes are OpenCV (+x right, +y down, +z forward); `c2w` maps camera to world.
Pixel (0, 0) is the top-left corner; the first pixel's center is (0.5, 0.5).
"""
