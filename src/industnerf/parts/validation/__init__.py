"""Checks of meshes, and the verdict on CAD files of the user's own."""
