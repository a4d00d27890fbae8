"""The method on photographs of your own: posed images in, a colored cloud out.

Lengths are in the unit of the cameras that are given, and the frame is theirs.
"""
