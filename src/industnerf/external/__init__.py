"""Clouds that were made elsewhere, scored as the study scores its own: `pipeline.score`."""
