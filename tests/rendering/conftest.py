"""What the tests of rendering share."""

from industnerf.torch_kernels import use_reproducible_kernels

use_reproducible_kernels()  # the suite is spread over processes already
