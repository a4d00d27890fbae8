"""Photographs as the polish reads them."""

import tracemalloc

import numpy as np

from industnerf.methods.industnerf_plus.pictures import Pictures


def test_no_copy_of_all_photographs_is_made_in_floating_point():
    rgb = np.random.default_rng(0).integers(0, 255, (10, 256, 256, 3)).astype(np.uint8)
    outlines = np.zeros(rgb.shape[:3], np.float32)
    tracemalloc.start()
    pictures = Pictures(rgb, np.ones((10, 3)), outlines)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 5 * rgb.nbytes  # brightness alone is 4/3
    np.testing.assert_array_equal(pictures.gray, (rgb.astype(np.float32).mean(3) / 255).ravel())
