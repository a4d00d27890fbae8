"""The ray that is shown is the ray that was rendered."""

import numpy as np
import torch

from industnerf.report.method.profile import off_axis, profile
from industnerf.report.method.seeing import chosen_pixel


def test_it_adds_up_to_the_rendered_pixel(making):
    row, column = chosen_pixel(making)
    met = profile(making, row, column)
    through = 1 - met.weights.sum()
    pixel = (met.weights[:, None] * met.rgb).sum(0) + through  # before white
    shown = making.rendered.rgb[0, row, column] / 255
    # 8 bits round by 1/510; the compiled kernel's exponential differs by some 1e-4
    assert np.abs(pixel.numpy() - shown).max() < 1 / 510 + 1e-3


def test_light_only_ever_gets_less(making):
    met = profile(making, *chosen_pixel(making))
    assert met.transmittance[0] == 1
    assert (met.transmittance.diff() <= 0).all()
    assert (met.t.diff() > 0).all()


def test_off_axis_is_the_distance_to_the_line():
    points = torch.tensor([[5.0, 3.0, 4.0], [-2.0, 0.0, 0.0]])
    away = off_axis(points, torch.zeros(3), torch.tensor([1.0, 0.0, 0.0]))
    assert away.tolist() == [5.0, 0.0]
