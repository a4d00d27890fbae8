"""A quick look at clouds and meshes of anybody's: `python -m industnerf.view`."""
