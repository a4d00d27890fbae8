"""What methods share that learn from other parts: pictures, targets, encoder, training loop.

All shapes are in the unit cube [-1/2, 1/2]^3 of `geometry.boxes.Cube`.
"""
