"""Photographs of a part: camera poses, lighting, shading, sensor."""
