"""The ray that is shown is the ray that was rendered."""

import numpy as np
import torch

from industnerf.report.docs.method_figures.fig_rendering import central_opaque_pixel
from industnerf.report.docs.method_figures.ray_profile import distance_to_line, trace_ray


def test_it_adds_up_to_the_rendered_pixel(trace):
    row, column = central_opaque_pixel(trace)
    ray = trace_ray(trace, row, column)
    transmitted = 1 - ray.weights.sum()
    pixel = (ray.weights[:, None] * ray.rgb).sum(0) + transmitted  # before white
    rendered = trace.rendered.rgb[0, row, column] / 255
    # 8 bits round by 1/510; the compiled kernel's exponential differs by some 1e-4
    assert np.abs(pixel.numpy() - rendered).max() < 1 / 510 + 1e-3


def test_light_only_ever_gets_less(trace):
    ray = trace_ray(trace, *central_opaque_pixel(trace))
    assert ray.transmittance[0] == 1
    assert (ray.transmittance.diff() <= 0).all()
    assert (ray.t.diff() > 0).all()


def test_off_axis_is_the_distance_to_the_line():
    points = torch.tensor([[5.0, 3.0, 4.0], [-2.0, 0.0, 0.0]])
    distances = distance_to_line(points, torch.zeros(3), torch.tensor([1.0, 0.0, 0.0]))
    assert distances.tolist() == [5.0, 0.0]
