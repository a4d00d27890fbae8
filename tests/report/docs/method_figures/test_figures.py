"""The figures: all are drawn, and docs/reference/method.md shows those that there are."""

import io
import re

import numpy as np
import torch
from PIL import Image

from industnerf.report.docs.method_figures.fig_inputs import (
    grid_slice,
    mosaic,
    principal_components,
)
from industnerf.report.docs.method_figures.figures import FIGURES, write_figures


def test_every_figure_shows_something(trace, tmp_path):
    written = write_figures(trace, tmp_path)
    assert [path.name for path in written] == list(FIGURES)
    for path in written:
        pixels = np.asarray(Image.open(io.BytesIO(path.read_bytes())).convert("L"))
        assert pixels.shape[1] == 900
        assert (pixels < 250).mean() > 0.01, path.name


def test_figures_that_are_no_more_are_removed(trace, tmp_path, monkeypatch):
    (tmp_path / "03-features.png").write_bytes(b"old")
    monkeypatch.setattr(
        "industnerf.report.docs.method_figures.figures.FIGURES", {"03-features.png": lambda _: None}
    )
    assert write_figures(trace, tmp_path) == []
    assert not list(tmp_path.iterdir())


def test_the_document_shows_every_figure_and_no_other(root):
    linked = re.findall(r"\]\(method/(\S+\.png)\)", (root / "docs/reference/method.md").read_text())
    sizes = {path.name: path.stat().st_size for path in (root / "docs/reference/method").iterdir()}
    assert set(linked) == set(sizes) == set(FIGURES)
    assert sum(sizes.values()) < 1.5e6  # bytes: they are part of the repository


def test_mosaic_goes_by_rows_and_ends_in_white():
    table = mosaic(np.arange(9, dtype=np.uint8).repeat(3).reshape(9, 1, 1, 3))
    assert table[..., 0].tolist() == [list(range(8)), [8, *[255] * 7]]


def test_the_first_component_is_what_varies_most():
    along = torch.linspace(-1, 1, 101)
    rows = torch.stack([along, -along, along, 0.1 * (17 * along).sin()], dim=1)
    shades = principal_components(rows)
    assert shades.min() == 0
    assert shades.max() == 1
    steps = shades[:, 0].diff()
    assert (steps >= 0).all() or (steps <= 0).all()


def test_a_slice_has_nothing_beyond_the_ball(trace):
    ones = torch.ones_like(trace.coarse.sigma[:, None])
    plane = grid_slice(trace, ones)[..., 0]
    assert np.isnan(plane[0, 0])
    assert np.nansum(plane) == (~np.isnan(plane)).sum() > 0
