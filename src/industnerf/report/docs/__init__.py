"""README.md and docs/: generated blocks, the list of parameters, the figures of the method."""
