"""Parts as files for other programs: exact or faceted STEP, and triangles with their colors."""
