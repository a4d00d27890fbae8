"""The deviation of a cloud from its CAD file: `python -m industnerf.deviation`."""
