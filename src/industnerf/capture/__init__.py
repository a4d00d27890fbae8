"""Photographs of a part: where the cameras stand, how the part is lit, what each pixel shows."""
