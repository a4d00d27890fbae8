"""Tests of the paper's method compute on one core."""

import torch

torch.set_num_threads(1)
