"""Tests of the paper's method compute on one core."""

from industnerf.torch_kernels import use_reproducible_kernels

use_reproducible_kernels()
