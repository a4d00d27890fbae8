"""All figures of one part, in the order of the paper's figure 2."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from industnerf.config import load_params
from industnerf.geometry.cameras import common_view_ball
from industnerf.methods.base import load_inputs
from industnerf.methods.industnerf import METHODS
from industnerf.methods.industnerf.scene import PosedImages
from industnerf.report.docs.method_figures import (
    fig_confidence,
    fig_inputs,
    fig_rendering,
    fig_sampling,
)
from industnerf.report.docs.method_figures.pipeline_trace import PipelineTrace, trace_pipeline
from industnerf.report.figures.figure_style import encode_png
from industnerf.seeds import seed_for

METHOD = METHODS["industnerf"]
# A figure is None where the settings leave out what it would show.
FIGURES: dict[str, Callable[[PipelineTrace], Any]] = {
    "01-views.png": fig_inputs.plot_views,
    "02-grid.png": fig_inputs.plot_grid,
    "03-features.png": fig_inputs.plot_features,
    "04-field.png": fig_inputs.plot_field,
    "05-distribution.png": fig_sampling.plot_density_pdf,
    "06-refined.png": fig_sampling.plot_refined_points,
    "07-ray.png": fig_rendering.plot_ray,
    "08-rerendered.png": fig_rendering.plot_rerendering,
    "09-confidence.png": fig_confidence.plot_confidence,
    "10-cloud.png": fig_confidence.plot_cloud,
}


def trace_part(views: Path) -> PipelineTrace:
    """The study's run of the part whose photographs are in `views`."""
    params, part_id = load_params(), views.name
    loaded = load_inputs(METHOD, views, views)  # the method takes nothing of the part itself
    center, radius = common_view_ball(loaded.cameras)
    seed = seed_for(params.seed, "reconstruct", METHOD.name, part_id)
    images = PosedImages(loaded.rgb, loaded.cameras, None, center, radius)
    return trace_pipeline(part_id, images, params.method.industnerf, seed)


def write_figures(trace: PipelineTrace, out: Path) -> list[Path]:
    """Replace the figures in `out`; returns those that there are."""
    out.mkdir(parents=True, exist_ok=True)
    written = []
    for name, draw in FIGURES.items():
        (out / name).unlink(missing_ok=True)
        fig = draw(trace)
        if fig is not None:
            (out / name).write_bytes(encode_png(fig))
            written.append(out / name)
    return written
