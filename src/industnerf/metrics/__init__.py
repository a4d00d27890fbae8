"""Scores of a point cloud against a part's true surface: numpy, scipy and POT, nothing else."""
