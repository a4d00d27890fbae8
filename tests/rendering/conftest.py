"""What the tests of rendering share."""

import torch

torch.set_num_threads(1)  # the suite is spread over processes already
