"""README.md and docs/: their generated blocks, the list of parameters, the figures of the method."""
